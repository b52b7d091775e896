//! A custom estimator: ambient occlusion, which tests for every visible point how much of the hemisphere above it is
//! free.
//!
//! `cargo run --release --example custom_estimator -- render cornell --estimator occlusion --spp 64 -o occlusion.png`

use pathmark::Lab;
use pathmark::effect::EffectSet;
use pathmark::estimator::{Estimator, Probe};
use pathmark::math::{Ray, Rgb};
use pathmark::sampling::{Address, Purpose, SampleKey, Sampler, cosine_hemisphere};
use pathmark::scene::{Scene, SurfaceOrigin, Tests};
use std::process::ExitCode;

/// Objects further away than this do not darken a point.
const REACH: f64 = 40.0;

struct Occlusion;

impl Estimator for Occlusion {
    const ABOUT: &'static str = "ambient occlusion within 40 units";
    const SPP_MULTIPLE: u32 = 1;

    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let mut tests = Tests::default();
        let seen = scene.intersect::<X>(&ray, None, &mut tests);
        probe.ray(tests);
        let Some(hit) = seen else { return Rgb::WHITE };
        // Random numbers depend only on their address, so the image is the same under every schedule.
        let pair = sampler.pair(Address { key, bounce: 1, branch: 0, purpose: Purpose::Bsdf });
        let direction = hit.frame().to_world(cosine_hemisphere(pair));
        let from = SurfaceOrigin { primitive: hit.primitive, inside: hit.inside };
        let mut tests = Tests::default();
        let above = Ray { origin: hit.point, direction };
        let is_dark = scene.is_blocked::<X>(&above, Some(from), REACH, &mut tests);
        probe.ray(tests);
        if is_dark { Rgb::BLACK } else { Rgb::WHITE }
    }
}

fn main() -> ExitCode {
    pathmark::main(Lab::new().estimator("occlusion", Occlusion))
}
