//! A sphere as a target: sampled by the cone of directions that it subtends (Shirley, Wang and Zimmerman, "Monte Carlo
//! Techniques for Direct Lighting Calculations", 1996), uniformly over all directions from inside it, and by area if
//! only a small part can be reached.

use crate::math::{Frame, Ray, Real, Vec3, dot, sin_cos_turns};
use crate::sampling::{UNIFORM_SPHERE_DENSITY, uniform_sphere};
use crate::scene::{Hit, Sphere};
use std::f64::consts::PI;

/// The part of a sphere around an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cap {
    /// The direction from the sphere's centre to the middle of the cap.
    pub axis: Vec3,
    /// Its height, from 0 to the sphere's diameter.
    pub height: f64,
}

/// The sphere, or its reachable part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereTarget {
    sphere: Sphere,
    cap: Option<Cap>,
}

/// The sampling of directions from a point.
enum Way<'a> {
    /// Uniformly over all directions, because the point is inside.
    Everywhere,
    /// Uniformly over the area of the cap.
    Area(&'a Cap),
    /// Uniformly in the cone around an axis; the half angle is given as 1 - cos.
    Cone { axis: Vec3, one_minus_cos: f64 },
}

/// Returns 1 - cos of the half angle that a sphere subtends at `distance` from its centre, which must exceed the
/// radius. The error is a few rounding errors at any ratio, while 1 - sqrt(1 - (r/d)²) has no correct digit at 1e8.
#[inline(always)]
pub fn one_minus_cos<T: Real>(radius: T, distance: T) -> T {
    let sin = radius / distance;
    let cos2 = (distance - radius) / distance * ((distance + radius) / distance);
    sin * sin / (T::splat(1.0) + cos2.sqrt())
}

/// Samples a direction uniformly in the cone around an axis; the half angle is given as 1 - cos.
#[inline(always)]
pub fn towards_cap<T: Real>(axis: Vec3<T>, one_minus_cos: T, u: [T; 2]) -> Vec3<T> {
    let z = u[1] * one_minus_cos;
    let (sin, cos) = sin_cos_turns(u[0]);
    let r = (z * (T::splat(2.0) - z)).sqrt();
    Frame::around(axis).to_world(Vec3::new(r * cos, r * sin, T::splat(1.0) - z))
}

impl SphereTarget {
    pub(super) fn new(sphere: Sphere, cap: Option<Cap>) -> Self {
        Self { sphere, cap }
    }

    /// Returns the sphere, and the cap that is aimed at, if that is not the whole sphere.
    pub fn parts(&self) -> (Sphere, Option<Cap>) {
        (self.sphere, self.cap)
    }

    /// Returns the sampling of directions; `None` from a point on its own outside, because the sphere hides itself.
    #[inline(always)]
    fn way(&self, point: Vec3, own: Option<bool>) -> Option<Way<'_>> {
        let radius = self.sphere.radius;
        let offset = self.sphere.center - point;
        let square = dot(offset, offset);
        if own.unwrap_or(square <= radius * radius) {
            return Some(Way::Everywhere);
        }
        let distance = square.sqrt();
        if own.is_some() || distance <= radius {
            return None;
        }
        match &self.cap {
            // From the point, a cap of height r (d - r)/d is visible; a lower reachable cap is sampled by area.
            Some(cap) if cap.height * distance < radius * (distance - radius) => Some(Way::Area(cap)),
            _ => {
                let axis = offset * (1.0 / distance);
                Some(Way::Cone { axis, one_minus_cos: one_minus_cos(radius, distance) })
            }
        }
    }

    /// Samples a direction; `None` if the sampled one does not lead to the target.
    #[inline(always)]
    pub(super) fn aim(&self, point: Vec3, own: Option<bool>, u: [f64; 2]) -> Option<(Vec3, f64)> {
        match self.way(point, own)? {
            Way::Everywhere => Some((uniform_sphere(u), UNIFORM_SPHERE_DENSITY)),
            Way::Cone { axis, one_minus_cos } => {
                Some((towards_cap(axis, one_minus_cos, u), 0.5 / (PI * one_minus_cos)))
            }
            Way::Area(cap) => {
                let normal = towards_cap(cap.axis, cap.height / self.sphere.radius, u);
                let towards = self.sphere.center + normal * self.sphere.radius - point;
                let square = dot(towards, towards);
                let direction = towards * (1.0 / square.sqrt());
                let cos = -dot(direction, normal);
                (cos > 0.0).then(|| (direction, square / (cos * self.area())))
            }
        }
    }

    /// Returns the density of the direction of a ray that started at `ray.origin` and met the target at `hit`; 0 if it
    /// is never sampled.
    #[inline(always)]
    pub(super) fn density(&self, ray: &Ray, own: Option<bool>, hit: &Hit) -> f64 {
        match self.way(ray.origin, own) {
            None => 0.0,
            Some(Way::Everywhere) => UNIFORM_SPHERE_DENSITY,
            Some(Way::Cone { one_minus_cos, .. }) => 0.5 / (PI * one_minus_cos),
            Some(Way::Area(cap)) => {
                // |n - a|² equals 2 (1 - cos), without its cancellation.
                let off = hit.normal - cap.axis;
                if dot(off, off) * self.sphere.radius > 2.0 * cap.height {
                    return 0.0;
                }
                hit.t * hit.t / (dot(ray.direction, hit.normal).abs() * self.area())
            }
        }
    }

    pub(super) fn area(&self) -> f64 {
        let radius = self.sphere.radius;
        2.0 * PI * radius * self.cap.map_or(2.0 * radius, |cap| cap.height)
    }
}
