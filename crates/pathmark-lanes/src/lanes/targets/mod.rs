//! Lights for next-event estimation in lanes: the choices of [`Lights`] with a mask in place of each branch, and the
//! same bits.

mod sphere;
mod triangle;

use super::tables::MOST_ROWS;
use crate::simd::{Column, Float, Table};
use pathmark_tracer::math::{Precision, Ray, Vec3};
use pathmark_tracer::scene::{AnyTarget, Lights, NO_LIGHT};
use sphere::Spheres;
use triangle::Triangles;

/// The lights of a scene that has any.
pub(super) struct Targets {
    spheres: Option<Spheres>,
    triangles: Option<Triangles>,
    /// For each light: number of the primitive, probability of its choice, area that is aimed at, 1 for triangles.
    all: Table,
    /// For each light the probability that it or one before it is chosen.
    up_to: Vec<f64>,
    of_primitive: OfPrimitive,
}

/// The light of each primitive, or -1.
enum OfPrimitive {
    Rows(Box<Table>),
    /// For many primitives: 4 bytes each instead of 16 or 32, and slightly slower.
    Column(Column),
}

impl OfPrimitive {
    fn of(lights: &[u32], precision: Precision) -> Self {
        let numbers = lights.iter().map(|light| if *light == NO_LIGHT { -1.0 } else { f64::from(*light) });
        if lights.len() > MOST_ROWS {
            return Self::Column(Column::new(numbers.map(|number| number as f32)));
        }
        Self::Rows(Box::new(Table::new(numbers.map(|number| [number, 0.0, 0.0, 0.0]), precision)))
    }

    #[inline(always)]
    fn at<V: Float>(&self, primitives: V) -> V {
        match self {
            Self::Rows(table) => {
                let [light, ..] = V::rows(table, primitives);
                light
            }
            Self::Column(column) => column.at(primitives),
        }
    }
}

/// Sampled directions towards lights.
pub(super) struct Aims<V: Float> {
    /// The lanes with a direction.
    pub(super) lanes: V::Mask,
    /// The direction, of length 1.
    pub(super) direction: Vec3<V>,
    /// The primitive that the direction aims at.
    pub(super) primitive: V,
    /// Density of the light and the direction, per steradian.
    pub(super) density: V,
}

/// Start of a ray or an aim.
#[derive(Clone, Copy)]
pub(super) struct Start<V: Float> {
    pub(super) point: Vec3<V>,
    /// The primitive that it is on; -1 if none.
    pub(super) primitive: V,
    /// Whether it is on the primitive's inside.
    pub(super) inside: V::Mask,
}

/// Intersection points of rays.
#[derive(Clone, Copy)]
pub(super) struct Met<V> {
    pub(super) primitive: V,
    /// Its distance along the ray.
    pub(super) t: V,
    /// Its outward normal at the point.
    pub(super) normal: Vec3<V>,
}

/// A chosen light for each lane.
struct Chosen<V: Float> {
    light: V,
    primitive: V,
    chance: V,
    area: V,
    is_triangle: V::Mask,
}

/// Sampled directions, the lanes that have one, and the densities per steradian.
#[derive(Clone, Copy)]
struct Directions<V: Float> {
    lanes: V::Mask,
    direction: Vec3<V>,
    density: V,
}

impl<V: Float> Directions<V> {
    #[inline(always)]
    fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        Self {
            lanes: (mask & yes.lanes) | (!mask & no.lanes),
            direction: Vec3::select(mask, yes.direction, no.direction),
            density: V::select(mask, yes.density, no.density),
        }
    }
}

impl Targets {
    /// The lights in tables; `None` if there are none.
    pub(super) fn of(lights: &Lights, precision: Precision) -> Option<Self> {
        if lights.lights.is_empty() {
            return None;
        }
        let all = lights.lights.iter().map(|light| {
            let is_triangle = matches!(light.target, AnyTarget::Triangle(_));
            [f64::from(light.primitive), light.chance, light.target.area(), f64::from(u8::from(is_triangle))]
        });
        Some(Self {
            spheres: Spheres::of(lights, precision),
            triangles: Triangles::of(lights, precision),
            all: Table::new(all, precision),
            up_to: lights.lights.iter().map(|light| light.up_to).collect(),
            of_primitive: OfPrimitive::of(&lights.of_primitive, precision),
        })
    }

    #[inline(always)]
    fn chosen<V: Float>(&self, light: V) -> Chosen<V> {
        let [primitive, chance, area, kind] = V::rows(&self.all, light);
        Chosen { light, primitive, chance, area, is_triangle: V::splat(0.5).lt(kind) }
    }

    /// Whether the choice of a light needs a random number.
    pub(super) fn are_several(&self) -> bool {
        self.up_to.len() > 1
    }

    /// Chooses a light for each lane and returns its number.
    #[inline(always)]
    fn choose<V: Float>(&self, number: V) -> V {
        let mut light = V::splat(0.0);
        if !self.are_several() {
            return light;
        }
        let last = self.up_to.len() - 1;
        let mut lane = 0;
        while lane < V::LANES {
            let number = number.lane(lane);
            // The last sum may fall short of 1 by rounding.
            let index = self.up_to.partition_point(|up_to| *up_to <= number).min(last);
            light.set_lane(lane, index as f64);
            lane += 1;
        }
        light
    }

    /// Samples directions towards lights. `choice` is read only if there are several lights.
    #[inline(always)]
    pub(super) fn aim<V: Float>(&self, start: &Start<V>, choice: V, place: [V; 2]) -> Aims<V> {
        let light = self.chosen::<V>(self.choose(choice));
        let found = match (&self.spheres, &self.triangles) {
            (Some(spheres), None) => spheres.aim(&light, start, place),
            (None, Some(triangles)) => triangles.aim(&light, start, place),
            (Some(spheres), Some(triangles)) => Directions::select(
                light.is_triangle,
                triangles.aim(&light, start, place),
                spheres.aim(&light, start, place),
            ),
            (None, None) => unreachable!("a light is a sphere or a triangle"),
        };
        let density = light.chance * found.density;
        let lanes = found.lanes & V::splat(0.0).lt(density) & density.lt(V::splat(f64::INFINITY));
        Aims { lanes, direction: found.direction, primitive: light.primitive, density }
    }

    /// The density with which [`Targets::aim`] chooses the directions of rays; 0 if they meet no light.
    #[inline(always)]
    pub(super) fn density<V: Float>(&self, start: &Start<V>, ray: &Ray<V>, met: &Met<V>) -> V {
        let zero = V::splat(0.0);
        let light = self.of_primitive.at(met.primitive);
        let is_target = zero.le(light);
        let light = self.chosen::<V>(light);
        let density = match (&self.spheres, &self.triangles) {
            (Some(spheres), None) => spheres.density(&light, start, ray, met),
            (None, Some(triangles)) => triangles.density(&light, ray, met),
            (Some(spheres), Some(triangles)) => V::select(
                light.is_triangle,
                triangles.density(&light, ray, met),
                spheres.density(&light, start, ray, met),
            ),
            (None, None) => unreachable!("a light is a sphere or a triangle"),
        };
        V::select(is_target, light.chance * density, zero)
    }
}
