//! Camera rays: the start of a path, and the light that further camera rays of its sample see.

use super::Probe;
use crate::effect::EffectSet;
use crate::math::{Ray, Rgb, dot};
use crate::sampling::{Address, Purpose, SampleKey, Sampler};
use crate::scene::{AllEffects, BACKGROUND, FOG, LENS, Scene, Tests, View};

/// Creates camera ray `number` of a sample through the pixel in column `x` of row `y`, whose index is in the key. The
/// path starts with number 0.
#[inline(always)]
pub fn camera_ray<S: Sampler, X: EffectSet, P: Probe>(
    view: &View,
    [x, y]: [u32; 2],
    key: SampleKey,
    number: u16,
    sampler: &S,
    probe: &mut P,
) -> Ray {
    let pair = |purpose| sampler.pair(Address { key, bounce: 0, branch: number, purpose });
    view.ray::<X>(x, y, key.sample, pair(Purpose::Film), || {
        probe.used(LENS);
        pair(Purpose::Lens)
    })
}

/// The weight of each camera ray in the mean of the light that a sample's camera rays see.
#[inline]
pub fn camera_share(camera_rays: u16) -> f64 {
    1.0 / f64::from(camera_rays)
}

/// The light that a sample's camera rays from number 1 on see, as their part of the mean over all its camera rays. The
/// path scales the light that its own ray sees by [`camera_share`], so the sum is unbiased. This is splitting (Arvo and
/// Kirk, "Particle transport and image synthesis", 1990) at the camera, where the other rays collect only emission.
/// Compiled once, with every effect and for any sampler.
pub fn extra_camera_rays(
    scene: &Scene,
    view: &View,
    pixel: [u32; 2],
    key: SampleKey,
    camera_rays: u16,
    sampler: &dyn Sampler,
    mut probe: &mut dyn Probe,
) -> Rgb {
    let mut seen = Rgb::BLACK;
    for number in 1..camera_rays {
        let ray =
            camera_ray::<&dyn Sampler, AllEffects, &mut dyn Probe>(view, pixel, key, number, &sampler, &mut probe);
        seen += seen_along(scene, &ray, probe);
    }
    let seen = seen * camera_share(camera_rays);
    probe.light(0, seen);
    seen
}

/// The radiance that arrives unscattered along a camera ray: from its first hit or the background, and from the fog
/// before it.
fn seen_along(scene: &Scene, ray: &Ray, probe: &mut dyn Probe) -> Rgb {
    let mut tests = Tests::default();
    let hit = scene.intersect::<AllEffects>(ray, None, &mut tests);
    probe.ray(tests);
    let behind = if let Some(hit) = &hit {
        scene.objects[hit.object as usize].emitted::<AllEffects>(dot(ray.direction, hit.normal).abs())
    } else {
        let background = scene.background.unwrap_or(Rgb::BLACK);
        if !background.is_black() {
            probe.used(BACKGROUND);
        }
        background
    };
    let Some(fog) = &scene.fog else { return behind };
    probe.used(FOG);
    let reach = hit.map_or(f64::INFINITY, |hit| hit.t);
    fog.unhindered_glow(reach) + behind * fog.unhindered(reach)
}
