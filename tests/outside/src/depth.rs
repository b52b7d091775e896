//! An estimator outside Pathmark: the distance of the visible surface.

use pathmark::effect::EffectSet;
use pathmark::estimator::{Estimator, Probe};
use pathmark::math::{Ray, Rgb};
use pathmark::sampling::{SampleKey, Sampler};
use pathmark::scene::{Scene, Tests};

pub struct Depth;

impl Estimator for Depth {
    const ABOUT: &'static str = "the distance of what is seen";
    const SPP_MULTIPLE: u32 = 1;

    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        _key: SampleKey,
        _sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let mut tests = Tests::default();
        let hit = scene.intersect::<X>(&ray, None, &mut tests);
        probe.ray(tests);
        Rgb::WHITE * hit.map_or(0.0, |hit| 1.0 / (1.0 + hit.t))
    }
}
