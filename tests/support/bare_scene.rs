//! Scenes of bare primitives.

use pathmark::math::Ray;
use pathmark::scene::{AllEffects, Hit, Primitives, Scene, Standpoint, Tests, load};

/// A scene of these primitives, all of one object; its camera is of no interest.
pub(crate) fn scene_of(primitives: Primitives) -> Scene {
    let mut scene = load("furnace").expect("a shipped scene");
    scene.owners = vec![0; primitives.counts().iter().sum()];
    scene.primitives = primitives;
    scene
}

/// What the ray meets first.
pub(crate) fn intersect(scene: &Scene, ray: &Ray, from: Option<Standpoint>) -> Option<Hit> {
    scene.intersect::<AllEffects>(ray, from, &mut Tests::default())
}
