//! Small renders of the cases, and the means of their images.

use super::Trials;
use crate::error::Result;
use crate::film::Film;
use crate::kernel::{KERNELS, Spec};
use crate::measure::{Outcome, Settings, Setup, available_threads};
use crate::scene::Scene;
use std::sync::Arc;

/// An image with default settings but for these.
pub(super) fn spec(estimator: &str, kernel: &str, [width, height]: [u32; 2], seed: u64) -> Spec {
    Spec { width, height, seed, estimator: estimator.into(), kernel: kernel.into(), ..Spec::default() }
}

pub(super) fn by_kernel(spec: &Spec) -> impl Iterator<Item = Spec> + '_ {
    KERNELS.iter().map(|kernel| Spec { kernel: kernel.name.to_string(), ..spec.clone() })
}

fn outcome(scene: &Arc<Scene>, spec: Spec, spp: u32) -> Result<Outcome> {
    let (decomposition, strategy) = ("rows".to_string(), "shared-counter".to_string());
    let settings = Settings { spp, spec, decomposition, strategy, threads: available_threads(), ..Settings::default() };
    Setup::for_scene(Arc::clone(scene), settings)?.run(None)
}

/// Renders `spp` samples of each pixel. Returns `None`, and records the reason, if the spec does not fit this scene.
pub(super) fn try_render(trials: &mut Trials, scene: &Arc<Scene>, spec: Spec, spp: u32) -> Option<Outcome> {
    let told = format!("{}, {}, {}", scene.name, spec.estimator, spec.kernel);
    outcome(scene, spec, spp).map_err(|error| trials.skip(format!("{told}: {error}"))).ok()
}

/// The same for a spec that fits.
pub(super) fn run(scene: &Scene, spec: Spec, spp: u32) -> Outcome {
    outcome(&Arc::new(scene.clone()), spec, spp).expect("a render")
}

/// Mean over all samples of a film, and variance within the pixels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments {
    pub(super) mean: f64,
    /// The variance of a sample within its pixel.
    pub(super) variance: f64,
    pub(super) n: f64,
}

impl Moments {
    pub(super) fn of(film: &Film, channel: usize) -> Self {
        let (mut n, mut sum, mut spread) = (0.0, 0.0, 0.0);
        for pixel in film.pixels() {
            n += f64::from(pixel.count);
            sum += pixel.sum[channel];
            spread += pixel.square[channel] - pixel.sum[channel] * pixel.sum[channel] / f64::from(pixel.count);
        }
        Self { mean: sum / n, variance: spread.max(0.0) / (n - film.pixels().len() as f64), n }
    }

    /// The standard error of the mean.
    pub(super) fn error(&self) -> f64 {
        (self.variance / self.n).sqrt()
    }
}

/// Score of the difference of two means. It tells whether two images of a scene have the same mean, however each finds
/// light.
pub(super) fn difference(a: &Moments, b: &Moments) -> f64 {
    let error = libm::hypot(a.error(), b.error());
    if error > 0.0 {
        (a.mean - b.mean) / error
    } else if a.mean == b.mean {
        0.0
    } else {
        f64::INFINITY
    }
}

/// Checks against an exact value. The relative half-width, `limit` standard errors, must be at most `widest`;
/// otherwise the check has no power.
pub(super) fn exact(trials: &mut Trials, variant: &str, value: f64, found: &Moments, limit: f64, widest: f64) {
    let power = limit * found.error() / value;
    trials.at_most(format!("{variant}: limit times error, relative"), widest, power);
    // The spot in view is small, but not a point.
    let off = (found.mean - value).abs() - 1e-7 * value;
    let score = if off > 0.0 { off / found.error() } else { 0.0 };
    trials.deviates_below(format!("{variant}: {:.6} for {value:.6}", found.mean), limit, score);
}
