//! Estimates of small scenes, with error bars.

use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::check::exact;
use pathmark::kernel::Spec;
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::scene::Scene;
use std::sync::Arc;

pub(crate) use pathmark::check::exact::{arriving_estimators, full_estimators};
pub(crate) use pathmark::check::stage::*;

/// Probability of a false alarm in each test, over all its comparisons, two-sided.
const LEVEL: f64 = 1e-3;
/// A test whose interval is wider than this share of the exact value has no power.
const WIDEST: f64 = 3e-3;
/// Relative tolerance for the width of the spot, 2e-8 at distance 1, and for the rounding error of a sum.
const ROUNDING: f64 = 1e-7;
/// Pixels per row and per column; all see the same value.
const SIDE: u32 = 32;

/// Renders about so many samples of the scene's spot in all.
pub(crate) fn render(scene: &Scene, estimator: &str, samples: u32, max_depth: Option<u16>) -> Outcome {
    let spec = Spec { width: SIDE, height: SIDE, seed: 31, estimator: estimator.into(), max_depth, ..Spec::default() };
    let spp = samples.div_ceil(SIDE * SIDE).next_multiple_of(4);
    let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
    let settings = Settings { spp, spec, decomposition, strategy, threads: 2, ..Settings::default() };
    let outcome = Setup::for_scene(Arc::new(scene.clone()), settings).unwrap().run(None).unwrap();
    assert_eq!(outcome.counts.invalid, 0, "invalid samples");
    outcome
}

/// The mean of a channel over all samples, and its standard error.
pub(crate) fn mean(outcome: &Outcome, channel: usize) -> (f64, f64) {
    exact::mean(&outcome.film, channel)
}

/// Asserts that a channel has the exact value within its error bar, which must be narrow. `tests` is the number of
/// comparisons in the test.
pub(crate) fn assert_exact(what: &str, outcome: &Outcome, channel: usize, exact: f64, tests: usize) {
    let most = critical_value(sidak(LEVEL, tests).unwrap()).unwrap();
    let (found, error) = mean(outcome, channel);
    assert!(most * error <= WIDEST * exact, "{what}: no power, one standard error is {error} of {exact}");
    let allowed = most * error + ROUNDING * exact;
    assert!((found - exact).abs() <= allowed, "{what}: {found} instead of {exact}, error {error}");
}
