//! Independence of the order of samples and pieces.

use super::unguarded::f64_sum;
use crate::film::{Assembly, Bounds, DECOMPOSITIONS, SAMPLE_BLOCK, SampleSum, TileBuffer};
use crate::kernel::{KERNELS, Spec};
use crate::math::Rgb;
use crate::measure::{Settings, Setup};
use crate::scene::load;
use crate::strategy::{STRATEGIES, Workers};
use crate::{Case, Trials};
use rand::Rng;
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[Case { id: "P14", tries: "samples and pieces in any order", run: orders }];

fn uniform(random: &mut Pcg64Mcg) -> f64 {
    ((random.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
}

/// Exponential of a normal variate with standard deviation 3, by G. E. P. Box and M. E. Muller (1958).
fn log_normal(random: &mut Pcg64Mcg) -> f64 {
    let radius = (-2.0 * libm::log(uniform(random))).sqrt();
    libm::exp(3.0 * radius * libm::cos(TAU * uniform(random)))
}

fn shuffle<T>(values: &mut [T], random: &mut Pcg64Mcg) {
    for last in (1..values.len()).rev() {
        values.swap(last, (random.next_u64() % (last as u64 + 1)) as usize);
    }
}

/// 4096 log-normal samples in 1000 orders: running sums give dozens of results, pieces of a film give one.
fn orders(trials: &mut Trials) {
    const BOUNDS: Bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };
    let mut random = Pcg64Mcg::new(14);
    let values: Vec<f64> = (0..4096).map(|_| log_normal(&mut random)).collect();
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
        shuffle(&mut pieces, &mut random);
        shuffle(&mut shuffled, &mut random);
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

/// The image is the same for every strategy, decomposition and number of threads.
fn images(trials: &mut Trials) {
    let scene = Arc::new(load("cornell").expect("a shipped scene"));
    // Three subtrees of 32, 16 and 4 samples, so that a wrong order of addition shows.
    let small = |kernel: &str| {
        let spec = Spec { width: 9, height: 7, seed: 7, kernel: kernel.to_string(), ..Spec::default() };
        Settings { spp: 52, spec, decomposition: "rows".into(), strategy: "serial".into(), ..Settings::default() }
    };
    for kernel in KERNELS {
        let checksum = |settings| {
            let setup = Setup::for_scene(Arc::clone(&scene), settings).expect("settings that fit");
            setup.run(None).expect("a render").checksum
        };
        let expected = checksum(small(kernel.name));
        for strategy in STRATEGIES {
            // One thread is enough for strategies that ignore the number of threads.
            let threads: &[usize] = if strategy.workers == Workers::Threads { &[1, 2, 8] } else { &[1] };
            let mut others = Vec::new();
            for &threads in threads {
                let examples = DECOMPOSITIONS.iter().map(|entry| entry.example);
                for decomposition in examples.chain(["tiles:1x1", "tiles:5x3:spiral", "samples:16:4x4"]) {
                    let (strategy, decomposition) = (strategy.name.to_string(), decomposition.to_string());
                    let what = format!("{decomposition} on {threads}");
                    if checksum(Settings { decomposition, strategy, threads, ..small(kernel.name) }) != expected {
                        others.push(what);
                    }
                }
            }
            let found = if others.is_empty() { "the same".to_string() } else { others.join(", ") };
            trials.holds(format!("{}, {}", strategy.name, kernel.name), "the same", found, others.is_empty());
        }
    }
}
