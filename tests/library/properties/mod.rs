//! Properties of all inputs, tested on many: of geometry, sampling, plans, files and paths. Inputs are drawn from
//! fixed seeds; a failing input is shrunk before it is shown. `PATHMARK_THOROUGH=1` draws a hundred times as many.

mod files;
mod geometry;
mod paths;
mod plans;
mod sampling;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// `quick` cases, or a hundred times as many.
pub(crate) fn cases(quick: u32) -> ProptestConfig {
    let cases = if std::env::var_os("PATHMARK_THOROUGH").is_some() { 100 * quick } else { quick };
    ProptestConfig { cases, rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::default() }
}

/// Two random numbers as samplers return them, often extreme ones.
pub(crate) fn pair() -> impl Strategy<Value = [f64; 2]> {
    let last = 1.0 - f64::EPSILON / 2.0;
    let number =
        || prop_oneof![8 => 0.0..1.0, 1 => Just(0.0), 1 => Just(last), 1 => Just(0.5), 1 => Just(f64::EPSILON / 2.0)];
    [number(), number()]
}
