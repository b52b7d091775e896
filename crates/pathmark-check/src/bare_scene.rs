//! Scenes of bare primitives, searched with every accelerator.

use crate::math::Ray;
use crate::scene::{ACCELERATORS, Hit, Primitives, Scene, Sphere, SurfaceOrigin, load};

/// A scene of these primitives, all of one object. Its camera is irrelevant.
pub fn scene_of(primitives: Primitives) -> Scene {
    let mut scene = load("furnace").expect("a shipped scene");
    scene.owners = vec![0; primitives.counts().iter().sum()];
    scene.primitives = primitives;
    scene
}

pub fn scene_of_spheres(spheres: Vec<Sphere>) -> Scene {
    scene_of(Primitives { spheres, ..Primitives::default() })
}

/// The scene with each accelerator in turn. Without one, every primitive is tested.
pub fn searches(scene: &Scene) -> impl Iterator<Item = (&'static str, Scene)> + '_ {
    ACCELERATORS.iter().map(|entry| (entry.name, scene.accelerated(entry.name).unwrap_or_else(|| scene.clone())))
}

/// The first hit of the ray.
pub fn intersect(scene: &Scene, ray: &Ray, from: Option<SurfaceOrigin>) -> Option<Hit> {
    scene.first_of_any(ray, from)
}
