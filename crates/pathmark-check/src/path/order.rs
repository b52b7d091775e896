//! Equal bits whatever the order of samples and pieces, and on every machine.

use super::unguarded::f64_sum;
use crate::Trials;
use crate::exact::run;
use crate::film::{Assembly, Bounds, DECOMPOSITIONS, SAMPLE_BLOCK, SampleSum, TileBuffer};
use crate::kernel::{KERNELS, Spec};
use crate::math::{Rgb, sin_cos_turns};
use crate::measure::Settings;
use crate::random::Random;
use crate::rendering::{self, spec};
use crate::sampling::SAMPLERS;
use crate::scene::load;
use crate::strategy::{STRATEGIES, Workers};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// 4096 log-normal samples in 1000 orders: running sums give dozens of results, pieces of a film give one.
pub(super) fn orders(trials: &mut Trials) {
    const BOUNDS: Bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };
    let mut random = Random::new(14);
    let values: Vec<f64> = (0..4096).map(|_| libm::exp(random.normal(3.0))).collect();
    let piece = |start: u32| {
        let mut sum = SampleSum::default();
        values[start as usize..(start + SAMPLE_BLOCK) as usize].iter().for_each(|value| sum.add(Rgb::WHITE * *value));
        let mut tile = TileBuffer::new(BOUNDS);
        tile.row_mut(0)[0] = sum.total();
        (start..start + SAMPLE_BLOCK, tile)
    };
    let mut pieces: Vec<_> = (0..4096).step_by(SAMPLE_BLOCK as usize).map(piece).collect();
    let mut shuffled = values.clone();
    let (mut fixed, mut running) = (BTreeSet::new(), BTreeSet::new());
    let count = trials.times(200, 1000);
    for _ in 0..count {
        random.shuffle(&mut pieces);
        random.shuffle(&mut shuffled);
        let mut assembly = Assembly::new(1, 1, 0..4096).expect("memory for a pixel");
        for (samples, tile) in &pieces {
            assembly.add(samples, tile.clone());
        }
        fixed.insert(assembly.finish().pixels()[0].sum[0].to_bits());
        running.insert(f64_sum(shuffled.iter().copied()).to_bits());
    }
    trials.same(format!("pieces in {count} orders: sums"), 1, fixed.len());
    let mut whole = SampleSum::default();
    for value in &values {
        whole.add(Rgb::WHITE * *value);
    }
    trials.same("pieces in any order: the undivided sum", true, fixed.contains(&whole.total().sum[0].to_bits()));
    let many = running.len();
    trials.holds(format!("unguarded, in {count} orders: sums"), "more than 10", many, many > 10);
    images(trials);
}

/// The image of each sampler is the same for every strategy, decomposition and number of threads.
fn images(trials: &mut Trials) {
    let scene = load("cornell").expect("a shipped scene");
    // Three subtrees of 32, 16 and 4 samples, so that a wrong order of addition shows.
    let small = |kernel: &str, sampler: &str| {
        let spec = Spec { sampler: sampler.to_string(), ..spec("smallpt", kernel, [9, 7], 7) };
        Settings { spp: 52, spec, decomposition: "rows".into(), strategy: "serial".into(), ..Settings::default() }
    };
    let examples = DECOMPOSITIONS.iter().map(|entry| entry.example);
    let decompositions: Vec<&str> = examples.chain(["tiles:1x1", "tiles:5x3:spiral", "samples:16:4x4"]).collect();
    let samplers = || SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name);
    let pairs = || samplers().flat_map(|sampler| decompositions.iter().map(move |own| (*own, sampler)));
    // A quick run takes two of them in turn.
    let few = trials.times(2, pairs().count() as u64) as usize;
    let mut turns = pairs().cycle();
    for kernel in KERNELS {
        let checksum = |settings| run(&scene, settings).checksum;
        let of = |sampler| (sampler, checksum(small(kernel.name, sampler)));
        let expected: BTreeMap<&str, Option<String>> = samplers().map(of).collect();
        let told = format!("{expected:?}");
        trials.holds(format!("{}, serial", kernel.name), "checksums", told, expected.values().all(Option::is_some));
        for strategy in STRATEGIES {
            // One thread is enough for strategies that ignore the number of threads.
            let threads: &[usize] = if strategy.workers == Workers::Threads { &[1, 2, 8] } else { &[1] };
            let mut others = Vec::new();
            for &threads in threads {
                for (decomposition, sampler) in turns.by_ref().take(few) {
                    let (strategy, decomposition) = (strategy.name.to_string(), decomposition.to_string());
                    let what = format!("{decomposition} by {sampler} on {threads}");
                    let settings = Settings { decomposition, strategy, threads, ..small(kernel.name, sampler) };
                    if checksum(settings) != expected[sampler] {
                        others.push(what);
                    }
                }
            }
            let found = if others.is_empty() { "the same".to_string() } else { others.join(", ") };
            trials.holds(format!("{}, {}", strategy.name, kernel.name), "the same", found, others.is_empty());
        }
    }
}

/// The checksum of [`crate::sampling::Entry::checksum`]'s image by smallpt's estimator, which splits paths.
const SMALLPT: (&str, &str, &str) = ("smallpt", "independent", "9e8357a5a669ae5d");

pub(super) fn bits(trials: &mut Trials) {
    let scene = load("cornell").expect("a shipped scene");
    let by_bsdf = SAMPLERS.iter().filter_map(|entry| Some(("bsdf", entry.name, entry.checksum?)));
    for (estimator, sampler, expected) in by_bsdf.chain([SMALLPT]) {
        let what = format!("cornell, {estimator}, {sampler}");
        let spec = Spec { sampler: sampler.to_string(), ..spec(estimator, KERNELS[0].name, [96, 64], 7) };
        trials.same(what, Some(expected.to_string()), rendering::run(&scene, spec, 8).checksum);
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
