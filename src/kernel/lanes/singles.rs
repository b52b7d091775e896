//! Spheres as single precision has them: by centre and radius where they are small, by curvature where they are as large as the scene.
//!
//! A centre 1e5 away leaves a coordinate of the scene seven hundredths of its unit. What [`Curved`] has instead is of the scene's own size. For
//! spheres that are small next to their distance from the origin it would be worse: k |x|² is that distance times the ratio of both.

use super::nearest::Found;
use super::packet::Rays;
use crate::math::{Curved, Vec3, curved_quadratic, dot, first_root, first_root_curved};
use crate::scene::Scene;
use crate::simd::Float;

/// The spheres of a scene, each with the number of its primitive.
pub(super) struct Singles {
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
        Self { curved, centred }
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
