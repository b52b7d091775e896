//! Spheres in single precision: by centre and radius if they are small, by curvature if they are as large as the scene
//! ([`Scene::large_spheres`]).
//!
//! A centre 1e5 away leaves a coordinate of the scene exact to only 0.008 units. [`SphereByCurvature`] stores
//! values of the scene's own size instead. For spheres that are small next to their distance from the origin it would
//! be worse: k |x|² is that distance times the ratio of distance to radius.
//!
//! If two surfaces meet at an angle, a point on one may be rounded to behind the other, as one point in 1e8 is in
//! scenes as wide as `sky`. A ray from there may meet nothing at all. A ray that starts behind a sphere that no path
//! leaves is therefore taken to meet it at once.

use super::rays::{Found, Rays};
use crate::simd::Float;
use pathmark_tracer::math::{
    SphereByCurvature, Vec3, curved_quadratic, dot, first_root, first_root_curved, last_root_curved,
};
use pathmark_tracer::scene::Scene;

/// The spheres of a scene, each with the number of its primitive.
pub(crate) struct SpheresF32 {
    /// The large spheres that no path leaves.
    enclosing: Vec<(f32, SphereByCurvature<f32>)>,
    curved: Vec<(f32, SphereByCurvature<f32>)>,
    /// The small spheres: centres and radii.
    centred: Vec<(f32, Vec3<f32>, f32)>,
}

fn single(v: Vec3) -> Vec3<f32> {
    Vec3 { x: v.x as f32, y: v.y as f32, z: v.z as f32 }
}

#[inline(always)]
fn splat<V: Float>(v: Vec3<f32>) -> Vec3<V> {
    Vec3 { x: V::splat(v.x.into()), y: V::splat(v.y.into()), z: V::splat(v.z.into()) }
}

impl SpheresF32 {
    pub(super) fn of(scene: &Scene, enclosing_all: &[u32]) -> Self {
        let (mut enclosing, mut curved, mut centred) = (Vec::new(), Vec::new(), Vec::new());
        for ((sphere, is_large), number) in scene.primitives.spheres.iter().zip(scene.large_spheres()).zip(0_u32..) {
            let is_enclosing = enclosing_all.contains(&number);
            let number = number as f32;
            if is_large {
                let SphereByCurvature { normal, curvature, offset } =
                    SphereByCurvature::of(sphere.center, sphere.radius);
                let sphere =
                    SphereByCurvature { normal: single(normal), curvature: curvature as f32, offset: offset as f32 };
                if is_enclosing { &mut enclosing } else { &mut curved }.push((number, sphere));
            } else {
                centred.push((number, single(sphere.center), sphere.radius as f32));
            }
        }
        Self { enclosing, curved, centred }
    }

    /// Only the spheres that are as large as the scene.
    pub(crate) fn large(scene: &Scene, enclosing_all: &[u32]) -> Self {
        Self { centred: Vec::new(), ..Self::of(scene, enclosing_all) }
    }

    /// The spheres by curvature with their numbers, and how many of them, from the first on, no path leaves.
    #[cfg(feature = "device")]
    pub(crate) fn in_order(&self) -> (usize, Vec<(u32, SphereByCurvature<f32>)>) {
        let all = self.enclosing.iter().chain(&self.curved).map(|(number, curved)| (*number as u32, *curved));
        (self.enclosing.len(), all.collect())
    }

    /// Whether the sphere with that number is one of these.
    pub(crate) fn contains(&self, number: u32) -> bool {
        self.numbers().any(|own| own == number)
    }

    /// The numbers of these spheres.
    pub(super) fn numbers(&self) -> impl Iterator<Item = u32> {
        let curved = self.enclosing.iter().chain(&self.curved).map(|(number, _)| *number as u32);
        curved.chain(self.centred.iter().map(|(number, ..)| *number as u32))
    }

    /// The nearest sphere along each ray. Among equally near spheres the lowest number wins; among large ones, spheres
    /// that no path leaves win first. A tree over the small ones ([`super::bvh`]) finds the same by the same formula.
    #[inline(always)]
    pub(super) fn scan<V: Float>(&self, rays: &Rays<V>) -> Found<V> {
        let (origin, direction) = (rays.ray.origin, rays.ray.direction);
        let (square, along) = (dot(origin, origin), dot(origin, direction));
        let mut found = Found::nothing();
        for (number, sphere) in &self.enclosing {
            let number = V::splat((*number).into());
            let (b, c) = curved_quadratic(&in_lanes(sphere), origin, direction, square, along);
            let root = last_root_curved(V::splat(sphere.curvature.into()), b, c);
            let distance = V::select(rays.from.equal(number), rays.own_root, root);
            let (zero, at_once) = (V::splat(0.0), V::splat(V::SMALLEST));
            found.take_from_anywhere(number, V::select(zero.lt(distance), distance, at_once));
        }
        for (number, sphere) in &self.curved {
            let (b, c) = curved_quadratic(&in_lanes(sphere), origin, direction, square, along);
            found.take(rays, V::splat((*number).into()), first_root_curved(V::splat(sphere.curvature.into()), b, c));
        }
        let mut small = Found::nothing();
        for (number, center, radius) in &self.centred {
            let offset = origin - splat::<V>(*center);
            let root = first_root(offset, direction, V::splat(1.0), V::splat(f64::from(*radius)));
            small.take(rays, V::splat((*number).into()), root);
        }
        found.take_in_any_order(small.primitive, small.nearest);
        found
    }
}

#[inline(always)]
fn in_lanes<V: Float>(sphere: &SphereByCurvature<f32>) -> SphereByCurvature<V> {
    SphereByCurvature {
        normal: splat::<V>(sphere.normal),
        curvature: V::splat(sphere.curvature.into()),
        offset: V::splat(sphere.offset.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Work, levels, on_level};
    use pathmark_tracer::math::Precision;
    use pathmark_tracer::math::Ray;
    use pathmark_tracer::scene::load;

    /// Distance and number found along a ray that starts on the primitive `from` and does not meet it again.
    struct Find<'a>(&'a SpheresF32, Vec3, Vec3, f64);

    impl Work for Find<'_> {
        type Output = (f64, f64);

        #[inline(always)]
        fn run<V: Float>(self) -> (f64, f64) {
            let Self(singles, origin, direction, from) = self;
            let ray = Ray { origin: splat::<V>(single(origin)), direction: splat(single(direction)) };
            let found = singles.scan(&Rays { ray, from: V::splat(from), own_root: V::splat(f64::NAN) });
            (found.nearest.lane(0), found.primitive.lane(0))
        }
    }

    /// Top-row rays of a small image start above the ceiling and meet the light there; rays of a larger image do not.
    #[test]
    fn spheres_that_rays_start_outside_of_are_not_enclosing() {
        let scene = load("cornell").unwrap();
        let ceiling = scene.objects.iter().position(|object| object.name == "ceiling").unwrap() as u32;
        let encloses =
            |[width, height]: [u32; 2]| scene.enclosing(&scene.camera.view(width, height)).contains(&ceiling);
        assert_eq!([[32, 24], [1024, 768]].map(encloses), [false, true]);
    }

    /// Where ground and sky meet, a point of the ground may be rounded to outside the sky. A ray from there that goes
    /// up and out meets the sky at once, and so does a ray from the sky itself. A ray that goes back in meets the other
    /// side of the sky.
    #[test]
    fn no_ray_leaves_an_enclosing_sphere() {
        let scene = load("sky").unwrap();
        let enclosing = scene.enclosing(&scene.camera.view(4, 4));
        assert_eq!(enclosing, [2]);
        let singles = SpheresF32::of(&scene, &enclosing);
        let [sky, ground] = [2, 3].map(|k: usize| &scene.primitives.spheres[k]);
        let across = ground.center - sky.center;
        let distance = dot(across, across).sqrt();
        // The circle in which both spheres meet: the distance of its centre from the sky's centre, and its radius.
        let along = (distance * distance + sky.radius * sky.radius - ground.radius * ground.radius) / (2.0 * distance);
        let circle = (sky.radius * sky.radius - along * along).sqrt();
        let down = across * (1.0 / distance);
        let side = down.cross(Vec3::new(0.0, 0.0, 1.0)).normalized();
        let edge = sky.center + down * along + side * circle;
        let out = (edge - sky.center) * (1.0 / sky.radius);
        for level in levels() {
            let find = |behind: f64, direction: Vec3, from: f64| {
                let ray = (edge + out * behind, direction.normalized());
                on_level(level, Precision::F32, Find(&singles, ray.0, ray.1, from))
            };
            for (behind, from) in [(2e-3, 3.0), (2e-3, 2.0), (0.0, 2.0)] {
                let (t, primitive) = find(behind, out - down, from);
                assert!(t > 0.0 && t < 1e-2 && primitive == 2.0, "{}: {t}, {primitive}", level.name());
            }
            let (t, primitive) = find(2e-3, -out - down, 3.0);
            assert!(t > 1e4 && primitive == 2.0, "{}: {t}, {primitive}", level.name());
        }
    }
}
