//! Spherical lights in lanes, as in `SphereTarget`.

use super::{Chosen, Directions, Met, Start};
use crate::simd::{Float, Mask, Table};
use pathmark_tracer::math::{Precision, Ray, Vec3, dot};
use pathmark_tracer::sampling::{UNIFORM_SPHERE_DENSITY, uniform_sphere};
use pathmark_tracer::scene::{AnyTarget, Lights, Sphere, one_minus_cos, towards_cap};
use std::f64::consts::PI;

/// The spheres among the lights.
pub(super) struct Spheres {
    /// Centre and radius.
    spheres: Table,
    /// Axis and height of the cap that can be reached; the height is infinite if the whole sphere can.
    caps: Table,
}

/// A sphere for each lane.
struct Target<V> {
    center: Vec3<V>,
    radius: V,
    axis: Vec3<V>,
    height: V,
}

/// Method to choose directions from a point, as in `SphereTarget`: by a cone if neither mask holds.
struct Way<V: Float> {
    exists: V::Mask,
    everywhere: V::Mask,
    by_area: V::Mask,
    axis: Vec3<V>,
    one_minus_cos: V,
}

impl Spheres {
    /// The spheres among the lights, in tables with a row for each light; `None` if there are none.
    pub(super) fn of(lights: &Lights, precision: Precision) -> Option<Self> {
        let rows = lights.lights.iter().map(|light| {
            let AnyTarget::Sphere(target) = &light.target else { return None };
            let (Sphere { center, radius }, cap) = target.parts();
            let (axis, height) = cap.map_or((Vec3::new(0.0, 0.0, 1.0), f64::INFINITY), |cap| (cap.axis, cap.height));
            Some([[center.x, center.y, center.z, radius], [axis.x, axis.y, axis.z, height]])
        });
        let rows: Vec<_> = rows.collect();
        let table = |k: usize| Table::new(rows.iter().map(|row| row.map_or([0.0; 4], |row| row[k])), precision);
        rows.iter().any(Option::is_some).then(|| Self { spheres: table(0), caps: table(1) })
    }

    #[inline(always)]
    fn target<V: Float>(&self, light: V) -> Target<V> {
        let [x, y, z, radius] = V::rows(&self.spheres, light);
        let [a, b, c, height] = V::rows(&self.caps, light);
        Target { center: Vec3::new(x, y, z), radius, axis: Vec3::new(a, b, c), height }
    }

    #[inline(always)]
    fn way<V: Float>(target: &Target<V>, light: &Chosen<V>, start: &Start<V>) -> Way<V> {
        let one = V::splat(1.0);
        let offset = target.center - start.point;
        let square = dot(offset, offset);
        let own = start.primitive.equal(light.primitive);
        let within = square.le(target.radius * target.radius);
        let everywhere = (own & start.inside) | (!own & within);
        let distance = square.sqrt();
        let hidden = !everywhere & (own | distance.le(target.radius));
        let lower = (target.height * distance).lt(target.radius * (distance - target.radius));
        let (axis, one_minus_cos) = (offset * (one / distance), one_minus_cos(target.radius, distance));
        Way { exists: !hidden, everywhere, by_area: !everywhere & !hidden & lower, axis, one_minus_cos }
    }

    #[inline(always)]
    pub(super) fn aim<V: Float>(&self, light: &Chosen<V>, start: &Start<V>, place: [V; 2]) -> Directions<V> {
        let one = V::splat(1.0);
        let target = self.target::<V>(light.light);
        let way = Self::way(&target, light, start);
        let axis = Vec3::select(way.by_area, target.axis, way.axis);
        let one_minus_cos = V::select(way.by_area, target.height / target.radius, way.one_minus_cos);
        let round = towards_cap(axis, one_minus_cos, place);

        let towards = target.center + round * target.radius - start.point;
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
        let leads_there = !way.by_area | V::splat(0.0).lt(cos);
        Directions { lanes: way.exists & leads_there, direction, density }
    }

    #[inline(always)]
    pub(super) fn density<V: Float>(&self, light: &Chosen<V>, start: &Start<V>, ray: &Ray<V>, met: &Met<V>) -> V {
        let zero = V::splat(0.0);
        let target = self.target::<V>(light.light);
        let way = Self::way(&target, light, start);
        let off = met.normal - target.axis;
        let beyond = (V::splat(2.0) * target.height).lt(dot(off, off) * target.radius);
        let by_area = met.t * met.t / (dot(ray.direction, met.normal).abs() * light.area);
        let by_area = V::select(beyond, zero, by_area);
        let density = V::splat(0.5) / (V::splat(PI) * way.one_minus_cos);
        let density = V::select(way.by_area, by_area, density);
        let density = V::select(way.everywhere, V::splat(UNIFORM_SPHERE_DENSITY), density);
        V::select(way.exists, density, zero)
    }
}
