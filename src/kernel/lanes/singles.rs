//! Spheres as single precision has them: by centre and radius where they are small, by curvature where they are as large as the scene.
//!
//! A centre 1e5 away leaves a coordinate of the scene seven hundredths of its unit. What [`Curved`] has instead is of the scene's own size. For
//! spheres that are small next to their distance from the origin it would be worse: k |x|² is that distance times the ratio of both.
//!
//! Where two surfaces meet at an angle, a point on one may be rounded to behind the other, as one in 1e8 is in scenes as wide as `sky`. What goes
//! on from there and meets nothing is still at the second surface, and [`Singles::slipped_through`] says which that is.

use super::nearest::Found;
use super::packet::Rays;
use crate::math::{Curved, Ray, Vec3, curved_quadratic, dot, first_root, first_root_curved};
use crate::scene::Scene;
use crate::simd::Float;

/// How far off a point of a surface may be, as a share of how far it is from the origin: a few roundings of its coordinates, and of the distance to
/// it, which may be twice that.
const ROUNDED: f64 = 8.0 * f32::EPSILON as f64;

/// The spheres of a scene, each with the number of its primitive.
pub(super) struct Singles {
    /// [`Scene::size`].
    size: f64,
    curved: Vec<(f32, Curved<f32>)>,
    /// Centres and radii.
    centred: Vec<(f32, Vec3<f32>, f32)>,
}

fn single(v: Vec3) -> Vec3<f32> {
    Vec3 { x: v.x as f32, y: v.y as f32, z: v.z as f32 }
}

#[inline(always)]
fn splat<V: Float>(v: Vec3<f32>) -> Vec3<V> {
    Vec3 { x: V::splat(v.x.into()), y: V::splat(v.y.into()), z: V::splat(v.z.into()) }
}

impl Singles {
    pub(super) fn of(scene: &Scene) -> Self {
        let size = scene.size();
        let (mut curved, mut centred) = (Vec::new(), Vec::new());
        for (number, sphere) in scene.primitives.spheres.iter().enumerate() {
            let number = number as f32;
            if sphere.radius < size {
                centred.push((number, single(sphere.center), sphere.radius as f32));
            } else {
                let Curved { normal, curvature, offset } = Curved::of(sphere.center, sphere.radius);
                let sphere = Curved { normal: single(normal), curvature: curvature as f32, offset: offset as f32 };
                curved.push((number, sphere));
            }
        }
        Self { size, curved, centred }
    }

    /// The sphere that a ray which meets nothing has just gone out of: not the one that it starts on, and no farther behind it than positions are
    /// rounded.
    #[inline(never)]
    pub(super) fn slipped_through(&self, scene: &Scene, ray: &Ray, from: f64) -> Option<f64> {
        let rounded = ROUNDED * (self.size + dot(ray.origin, ray.origin).sqrt());
        let spheres = scene.primitives.spheres.iter().zip(0_u32..);
        let left = spheres.filter_map(|(sphere, number)| {
            let f = ray.origin - sphere.center;
            let behind = (dot(f, f).sqrt() - sphere.radius).abs();
            let is_left = f64::from(number) != from && behind <= rounded && dot(f, ray.direction) > 0.0;
            is_left.then_some((behind, f64::from(number)))
        });
        left.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, number)| number)
    }

    /// The first sphere along each ray. Ties go to those by curvature, then to the
    /// lowest number.
    #[inline(always)]
    pub(super) fn scan<V: Float>(&self, rays: &Rays<V>) -> Found<V> {
        let (origin, direction) = (rays.ray.origin, rays.ray.direction);
        let (square, along) = (dot(origin, origin), dot(origin, direction));
        let mut found = Found::nothing();
        for (number, sphere) in &self.curved {
            let (b, c) = curved_quadratic(&in_lanes(sphere), origin, direction, square, along);
            found.take(rays, V::splat((*number).into()), first_root_curved(V::splat(sphere.curvature.into()), b, c));
        }
        for (number, center, radius) in &self.centred {
            let offset = origin - splat::<V>(*center);
            let root = first_root(offset, direction, V::splat(1.0), V::splat(f64::from(*radius)));
            found.take(rays, V::splat((*number).into()), root);
        }
        found
    }
}

#[inline(always)]
fn in_lanes<V: Float>(sphere: &Curved<f32>) -> Curved<V> {
    Curved {
        normal: splat::<V>(sphere.normal),
        curvature: V::splat(sphere.curvature.into()),
        offset: V::splat(sphere.offset.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::load;

    /// Where the ground meets the sky, a point of the ground that is rounded to outside of the sky is still at the sky for a ray that goes up and
    /// out; not for one that goes back in, one that starts farther out, or on the sky itself.
    #[test]
    fn rays_do_not_slip_between_ground_and_sky() {
        let scene = load("sky").unwrap();
        let [sky, ground] = [2, 3].map(|k: usize| &scene.primitives.spheres[k]);
        let singles = Singles::of(&scene);
        let across = ground.center - sky.center;
        let distance = dot(across, across).sqrt();
        // The circle in which both spheres meet: how far its middle is from the sky's, and its radius.
        let along = (distance * distance + sky.radius * sky.radius - ground.radius * ground.radius) / (2.0 * distance);
        let circle = (sky.radius * sky.radius - along * along).sqrt();
        let axis = across * (1.0 / distance);
        let side = axis.cross(Vec3::new(0.0, 0.0, 1.0)).normalized();
        let edge = sky.center + axis * along + side * circle;
        let out = (edge - sky.center) * (1.0 / sky.radius);
        let ask = |origin: Vec3, direction: Vec3, from: f64| {
            singles.slipped_through(&scene, &Ray { origin, direction }, from)
        };
        let up = -axis;
        let behind = edge + out * 2e-3;
        assert_eq!(ask(behind, (up + out).normalized(), 3.0), Some(2.0));
        assert_eq!(ask(behind, (up - out).normalized(), 3.0), None, "it goes back in");
        assert_eq!(ask(edge + out, (up + out).normalized(), 3.0), None, "it is outside");
        assert_eq!(ask(behind, (up + out).normalized(), 2.0), None, "it is on the sky");
        assert_eq!(ask(Vec3::new(0.0, 50.0, 0.0), up, -1.0), None, "it is in the middle");
    }
}
