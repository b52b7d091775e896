//! Spheres as targets, in SIMD lanes: [`SphereTarget`](super::sphere::SphereTarget)'s choices with a mask for each, and the same bits.

use super::{AnyTarget, Lights, NO_LIGHT};
use crate::math::{Ray, Vec3, dot};
use crate::sampling::{UNIFORM_SPHERE_DENSITY, uniform_sphere};
use crate::simd::{Float, Mask, Table};
use std::f64::consts::PI;

use super::sphere::{one_minus_cos, towards_cap};

/// The lights of a scene that has no others.
pub struct SphereLights {
    /// Centre and radius.
    spheres: Table,
    /// Axis and height of the part that can be reached; the height has no end where that is all.
    caps: Table,
    /// Number of the primitive, how often it is chosen, the area of what is aimed at.
    rest: Table,
    /// How often each light or one before it is chosen.
    up_to: Vec<f64>,
    /// The light of each primitive, or -1.
    of_primitive: Table,
}

/// Directions towards lights.
pub struct Aims<V: Float> {
    /// Where there is one.
    pub lanes: V::Mask,
    /// The direction, of length 1.
    pub direction: Vec3<V>,
    /// The primitive that it is to arrive at.
    pub primitive: V,
    /// How likely the light and the direction were, per steradian.
    pub density: V,
}

/// Where a ray or an aim starts: the number of the primitive that it is on, and whether on its inside.
#[derive(Clone, Copy)]
pub struct Start<V: Float> {
    /// The point.
    pub point: Vec3<V>,
    /// The primitive, -1 if none.
    pub primitive: V,
    /// The side.
    pub inside: V::Mask,
}

/// A light for each lane.
struct Chosen<V> {
    center: Vec3<V>,
    radius: V,
    axis: Vec3<V>,
    height: V,
    primitive: V,
    chance: V,
    area: V,
}

/// How directions are chosen from a point, as [`super::sphere`] has it; by a cone where neither mask holds.
struct Way<V: Float> {
    exists: V::Mask,
    everywhere: V::Mask,
    by_area: V::Mask,
    axis: Vec3<V>,
    one_minus_cos: V,
}

impl SphereLights {
    /// The lights in tables; `None` if there are none, or others.
    pub fn of(lights: &Lights) -> Option<Self> {
        let mut rows = [Vec::new(), Vec::new(), Vec::new()];
        for light in &lights.lights {
            let AnyTarget::Sphere(target) = &light.target else { return None };
            let (sphere, cap) = target.parts();
            let (axis, height) = cap.map_or((Vec3::new(0.0, 0.0, 1.0), f64::INFINITY), |cap| (cap.axis, cap.height));
            rows[0].push([sphere.center.x, sphere.center.y, sphere.center.z, sphere.radius]);
            rows[1].push([axis.x, axis.y, axis.z, height]);
            rows[2].push([f64::from(light.primitive), light.chance, light.target.area(), 0.0]);
        }
        if lights.lights.is_empty() {
            return None;
        }
        let number = |light: &u32| if *light == NO_LIGHT { -1.0 } else { f64::from(*light) };
        let of_primitive = lights.of_primitive.iter().map(|light| [number(light), 0.0, 0.0, 0.0]).collect();
        let [spheres, caps, rest] = rows.map(Table::new);
        let up_to = lights.lights.iter().map(|light| light.up_to).collect();
        Some(Self { spheres, caps, rest, up_to, of_primitive: Table::new(of_primitive) })
    }

    #[inline(always)]
    fn chosen<V: Float>(&self, light: V) -> Chosen<V> {
        let [x, y, z, radius] = V::rows(&self.spheres, light);
        let [a, b, c, height] = V::rows(&self.caps, light);
        let [primitive, chance, area, _] = V::rows(&self.rest, light);
        Chosen { center: Vec3::new(x, y, z), radius, axis: Vec3::new(a, b, c), height, primitive, chance, area }
    }

    /// Whether a number is needed to choose one.
    pub fn are_several(&self) -> bool {
        self.up_to.len() > 1
    }

    /// The number of a light for each lane.
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

    #[inline(always)]
    fn way<V: Float>(light: &Chosen<V>, start: &Start<V>) -> Way<V> {
        let one = V::splat(1.0);
        let offset = light.center - start.point;
        let square = dot(offset, offset);
        let own = start.primitive.equal(light.primitive);
        let within = square.le(light.radius * light.radius);
        let everywhere = (own & start.inside) | (!own & within);
        let distance = square.sqrt();
        let hidden = !everywhere & (own | distance.le(light.radius));
        let lower = (light.height * distance).lt(light.radius * (distance - light.radius));
        let (axis, one_minus_cos) = (offset * (one / distance), one_minus_cos(light.radius, distance));
        Way { exists: !hidden, everywhere, by_area: !everywhere & !hidden & lower, axis, one_minus_cos }
    }

    /// Directions towards lights. `choice` is looked at only where there are several.
    #[inline(always)]
    pub fn aim<V: Float>(&self, start: &Start<V>, choice: V, place: [V; 2]) -> Aims<V> {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let light = self.chosen::<V>(self.choose(choice));
        let way = Self::way(&light, start);
        let axis = Vec3::select(way.by_area, light.axis, way.axis);
        let one_minus_cos = V::select(way.by_area, light.height / light.radius, way.one_minus_cos);
        let round = towards_cap(axis, one_minus_cos, place);

        let towards = light.center + round * light.radius - start.point;
        let square = dot(towards, towards);
        let to_area = towards * (one / square.sqrt());
        let cos = -dot(to_area, round);
        let mut direction = Vec3::select(way.by_area, to_area, round);
        let by_cone = V::splat(0.5) / (V::splat(PI) * way.one_minus_cos);
        let mut density = V::select(way.by_area, square / (cos * light.area), by_cone);
        if way.everywhere.any() {
            direction = Vec3::select(way.everywhere, uniform_sphere(place), direction);
            density = V::select(way.everywhere, V::splat(UNIFORM_SPHERE_DENSITY), density);
        }
        let density = light.chance * density;
        let leads_there = !way.by_area | zero.lt(cos);
        let lanes = way.exists & leads_there & zero.lt(density) & density.lt(V::splat(f64::INFINITY));
        Aims { lanes, direction, primitive: light.primitive, density }
    }

    /// How likely [`SphereLights::aim`] was to choose the directions of rays that met `primitive` at distance `t` and that normal.
    #[inline(always)]
    pub fn density<V: Float>(&self, start: &Start<V>, ray: &Ray<V>, primitive: V, t: V, normal: Vec3<V>) -> V {
        let zero = V::splat(0.0);
        let [light, ..] = V::rows(&self.of_primitive, primitive);
        let is_target = zero.le(light);
        let light = self.chosen::<V>(light);
        let way = Self::way(&light, start);
        let off = normal - light.axis;
        let beyond = (V::splat(2.0) * light.height).lt(dot(off, off) * light.radius);
        let by_area = t * t / (dot(ray.direction, normal).abs() * light.area);
        let by_area = V::select(beyond, zero, by_area);
        let density = V::splat(0.5) / (V::splat(PI) * way.one_minus_cos);
        let density = V::select(way.by_area, by_area, density);
        let density = V::select(way.everywhere, V::splat(UNIFORM_SPHERE_DENSITY), density);
        V::select(is_target & way.exists, light.chance * density, zero)
    }
}
