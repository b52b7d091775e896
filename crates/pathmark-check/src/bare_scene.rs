//! Scenes of bare primitives, searched with every accelerator.

use crate::math::Ray;
use crate::scene::{ACCELERATORS, Hit, Primitives, SCENES, Scan, Scene, Sphere, SurfaceOrigin, accelerator, load};

/// Every scene of the table. The one whose size is chosen is small.
pub fn every_scene() -> impl Iterator<Item = Scene> {
    let name = |name: &'static str| if name == "spheres" { "spheres:100" } else { name };
    SCENES.iter().map(move |(scene, _)| load(name(scene)).expect("a shipped scene"))
}

/// The same with an accelerator that fits.
pub fn every_accelerated_scene() -> impl Iterator<Item = Scene> {
    every_scene().map(|scene| {
        let fitting = accelerator(None, scene.owners.len(), Scan::OneByOne);
        fitting.and_then(|entry| scene.accelerated(entry.name)).unwrap_or(scene)
    })
}

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

pub fn intersect(scene: &Scene, ray: &Ray, from: Option<SurfaceOrigin>) -> Option<Hit> {
    scene.first_of_any(ray, from)
}
