//! What is rendered: shapes with materials and emission, a camera, and what effects they call for.

mod camera;
mod library;
mod profile;
mod reader;
mod sphere;

pub use camera::{Camera, SUBPIXELS, View};
pub use library::{SCENES, load};
pub use profile::{AllEffects, DiffuseOnly, PROFILES, ProfileEntry, ProfileVisitor, smallest_profile, with_profile};
pub use sphere::Sphere;

use crate::material::{Effects, Material};
use crate::math::{Ray, Rgb, Vec3, dot};

/// What is known of a thing in the scene besides its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// What the scene file calls it.
    pub name: String,
    /// What its surface does with light.
    pub material: Material,
    /// The radiance that it gives off in every direction, on both sides.
    pub emission: Rgb,
}

/// Where a path stands: on an object, on one of its sides. A ray that starts there needs no epsilon to miss its own start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Standpoint {
    /// Index of the object.
    pub object: u32,
    /// Whether the ray leaves to the object's inside.
    pub inside: bool,
}

/// The first thing that a ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance, in lengths of the ray's direction.
    pub t: f64,
    /// Index of the object.
    pub object: u32,
    /// The point.
    pub point: Vec3,
    /// The outward unit normal.
    pub normal: Vec3,
    /// Whether the ray arrives from the object's inside.
    pub inside: bool,
}

/// Everything that a kernel needs to know about what it renders.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Its name: the file's stem.
    pub name: String,
    /// What it is, in a line.
    pub about: String,
    /// SHA-256 of the definition's text, shortened to 16 hexadecimal digits.
    pub hash: String,
    /// The estimator that is used unless another is asked for.
    pub default_estimator: Option<String>,
    /// Where it is seen from.
    pub camera: Camera,
    /// The surface of each object, in the same order, which decides ties. Apart from the objects, so that the search for the nearest
    /// touches nothing else.
    pub shapes: Vec<Sphere>,
    /// What is in it.
    pub objects: Vec<Object>,
    /// The effects that its materials call for.
    pub effects: Effects,
}

impl Scene {
    /// The first object along the ray; among equally near ones the first in the scene. `from` is where the ray starts, if it starts
    /// on an object.
    #[inline(always)]
    pub fn intersect(&self, ray: &Ray, from: Option<Standpoint>) -> Option<Hit> {
        let own = from.map_or(u32::MAX, |standpoint| standpoint.object);
        let leave = from.map_or(f64::NAN, |from| self.shapes[from.object as usize].leave(ray, from.inside));
        let (mut t, mut object) = (f64::INFINITY, u32::MAX);
        for (index, shape) in (0u32..).zip(&self.shapes) {
            let meet = shape.meet(ray);
            let distance = if index == own { leave } else { meet };
            // NaN, zero and negative distances are no hits. Written as selections, because a processor cannot foresee which sphere
            // will turn out to be nearer: wrong guesses cost about a tenth of the kernel's time.
            let ahead = if distance > 0.0 { distance } else { f64::INFINITY };
            object = if ahead < t { index } else { object };
            t = if ahead < t { ahead } else { t };
        }
        let shape = self.shapes.get(object as usize)?;
        let point = ray.at(t);
        let normal = shape.normal(point);
        Some(Hit { t, object, point, normal, inside: dot(normal, ray.direction) > 0.0 })
    }

    /// The same scene in thermal equilibrium: every surface gives off exactly what it does not reflect (1 - albedo), so that in a
    /// closed scene the radiance is 1 everywhere, in every direction: an exact expectation for every pixel.
    #[must_use]
    pub fn in_equilibrium(&self) -> Self {
        let mut scene = self.clone();
        for object in &mut scene.objects {
            let albedo = object.material.albedo();
            object.emission = Rgb { r: 1.0 - albedo.r, g: 1.0 - albedo.g, b: 1.0 - albedo.b };
        }
        scene
    }

    /// The same scene with every length multiplied. By a power of two it must give the same bits.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scene = self.clone();
        scene.camera = scene.camera.scaled(factor);
        scene.shapes = scene.shapes.iter().map(|shape| shape.scaled(factor)).collect();
        scene
    }
}
