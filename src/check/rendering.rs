//! Small renders of the cases.

use super::Trials;
use crate::kernel::{KERNELS, Spec};
use crate::measure::{Outcome, Settings, Setup, available_threads};
use crate::scene::Scene;
use std::sync::Arc;

/// Renders `spp` samples of each pixel; `None`, with the reason written down, if the spec is not for this scene.
pub(super) fn render(trials: &mut Trials, scene: &Arc<Scene>, spec: Spec, spp: u32) -> Option<Outcome> {
    let (decomposition, strategy) = ("rows".to_string(), "shared-counter".to_string());
    let told = format!("{}, {}, {}", scene.name, spec.estimator, spec.kernel);
    let settings = Settings { spp, spec, decomposition, strategy, threads: available_threads(), ..Settings::default() };
    let outcome = Setup::for_scene(Arc::clone(scene), settings).and_then(|setup| setup.run(None));
    outcome.map_err(|error| trials.skip(format!("{told}: {error}"))).ok()
}

/// The spec for every kernel.
pub(super) fn by_kernel(spec: &Spec) -> impl Iterator<Item = Spec> + '_ {
    KERNELS.iter().map(|kernel| Spec { kernel: kernel.name.to_string(), ..spec.clone() })
}

/// The mean of a channel over all samples, and its standard error.
pub(super) fn mean(outcome: &Outcome, channel: usize) -> (f64, f64) {
    let (mut n, mut sum, mut square) = (0.0, 0.0, 0.0);
    for pixel in outcome.film.pixels() {
        n += f64::from(pixel.count);
        sum += pixel.sum[channel];
        square += pixel.square[channel];
    }
    let mean = sum / n;
    (mean, ((square / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
}
