//! Small renders of the cases.

use super::Trials;
use crate::kernel::{KERNELS, Spec};
use crate::measure::{Outcome, Settings, Setup, available_threads};
use crate::scene::Scene;
use std::sync::Arc;

/// Renders `spp` samples of each pixel. Returns `None`, and records the reason, if the spec does not fit this scene.
pub(super) fn render(trials: &mut Trials, scene: &Arc<Scene>, spec: Spec, spp: u32) -> Option<Outcome> {
    let (decomposition, strategy) = ("rows".to_string(), "shared-counter".to_string());
    let told = format!("{}, {}, {}", scene.name, spec.estimator, spec.kernel);
    let settings = Settings { spp, spec, decomposition, strategy, threads: available_threads(), ..Settings::default() };
    let outcome = Setup::for_scene(Arc::clone(scene), settings).and_then(|setup| setup.run(None));
    outcome.map_err(|error| trials.skip(format!("{told}: {error}"))).ok()
}

/// The spec with every kernel.
pub(super) fn by_kernel(spec: &Spec) -> impl Iterator<Item = Spec> + '_ {
    KERNELS.iter().map(|kernel| Spec { kernel: kernel.name.to_string(), ..spec.clone() })
}
