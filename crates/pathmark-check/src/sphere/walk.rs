//! A walk from surface to surface, step by step, without an estimator.

use crate::material::Material;
use crate::math::{Ray, Vec3};
use crate::scene::{AllEffects, Hit, Scene, SurfaceOrigin};

/// The next ray segment and its standpoint, for a ray that arrives along `direction`. `u` chooses the lobe. The new
/// direction is not normalised.
pub(super) fn scatter(scene: &Scene, hit: &Hit, direction: Vec3, u: f64) -> (Ray, SurfaceOrigin) {
    let frame = hit.frame();
    let material: &Material = &scene.objects[hit.object as usize].material;
    let sample = material.sample::<AllEffects>(frame.to_local(-direction), hit.inside, [u, 0.5]);
    let wi = sample.expect("nothing here absorbs").wi;
    let inside = (wi.z < 0.0) != hit.inside;
    (Ray { origin: hit.point, direction: frame.to_world(wi) }, SurfaceOrigin { primitive: hit.primitive, inside })
}
