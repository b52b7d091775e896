//! Equal bits on every machine.

use crate::kernel::Spec;
use crate::math::sin_cos_turns;
use crate::measure::{Settings, Setup};
use crate::sampling::SAMPLERS;
use crate::scene::load;
use crate::{Case, Trials};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::sync::Arc;

pub(super) const CASES: &[Case] =
    &[Case { id: "P18", tries: "the bits of another build and another machine", run: bits }];

/// The checksum of [`crate::sampling::Entry::checksum`]'s image by smallpt's estimator, which splits paths.
const SMALLPT: (&str, &str, &str) = ("smallpt", "independent", "9e8357a5a669ae5d");

fn bits(trials: &mut Trials) {
    let scene = Arc::new(load("cornell").expect("a shipped scene"));
    let by_bsdf = SAMPLERS.iter().filter_map(|entry| Some(("bsdf", entry.name, entry.checksum?)));
    for (estimator, sampler, expected) in by_bsdf.chain([SMALLPT]) {
        let (estimator, sampler) = (estimator.to_string(), sampler.to_string());
        let what = format!("cornell, {estimator}, {sampler}");
        let spec = Spec { width: 96, height: 64, seed: 7, estimator, sampler, ..Spec::default() };
        let settings = Settings { spp: 8, spec, ..Settings::default() };
        let setup = Setup::for_scene(Arc::clone(&scene), settings).expect("settings that fit");
        let found = setup.run(None).expect("a render").checksum;
        trials.same(what, Some(expected.to_string()), found);
    }
    own_functions(trials);
}

/// Sine and cosine are the program's own. Quarter turns are exact. An eighth of a turn is within 2.3e-16; against
/// libm, all angles up to it are within 3.5e-16.
fn own_functions(trials: &mut Trials) {
    for (turns, expected) in
        [(0.0, (0.0, 1.0)), (0.25, (1.0, 0.0)), (0.5, (0.0, -1.0)), (0.75, (-1.0, 0.0)), (1.0, (0.0, 1.0))]
    {
        let (sin, cos) = sin_cos_turns(turns);
        trials.same(format!("{turns} turns"), expected, (sin + 0.0, cos + 0.0));
    }
    let (sin, cos) = sin_cos_turns(0.125);
    trials.close("an eighth of a turn: sine", FRAC_1_SQRT_2, sin, 2.3e-16);
    trials.close("an eighth of a turn: cosine", FRAC_1_SQRT_2, cos, 2.3e-16);
    let steps = trials.times(100_000, 10_000_000);
    let mut worst = 0.0_f64;
    for k in 0..=steps {
        let turns = 0.125 * k as f64 / steps as f64;
        let (sin, cos) = sin_cos_turns(turns);
        let (exact_sin, exact_cos) = (libm::sin(TAU * turns), libm::cos(TAU * turns));
        worst = worst.max((sin - exact_sin).abs()).max((cos - exact_cos).abs());
    }
    trials.holds(
        "against libm up to an eighth of a turn",
        "at most 3.5e-16",
        format_args!("{worst:.1e}"),
        worst <= 3.5e-16,
    );
}
