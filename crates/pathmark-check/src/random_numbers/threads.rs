//! Samplers whose random numbers depend on threads are flagged: R12.

use crate::kernel::{KERNELS, Spec};
use crate::rendering::{run, spec};
use crate::run::on_threads;
use crate::sampling::{Address, Purpose, SAMPLERS, SampleKey, stateful_sampler};
use crate::scene::load;
use crate::{Trials, critical};
use std::collections::BTreeSet;

/// Samplers that give equal numbers to several threads, wrong on purpose: all threads start alike, or some may.
const ALL_ALIKE: &str = "same-seed";
const SOME_ALIKE: &str = "racy";

/// The table flags these samplers, and their images have no checksum. Eight threads that draw at once get numbers in
/// [0, 1) with mean 1/2, and no two threads draw the same sequence, unless the sampler is there to show that error.
pub(super) fn shared(trials: &mut Trials) {
    let scene = load("cornell").expect("a shipped scene");
    let stateful = || SAMPLERS.iter().filter(|entry| !entry.deterministic);
    let limit = critical(stateful().count());
    let draws = trials.times(20_000, 2_000_000);
    for entry in stateful() {
        for kernel in KERNELS {
            let spec = Spec { sampler: entry.name.to_string(), ..spec("smallpt", kernel.name, [12, 9], 1) };
            let found = run(&scene, spec, 4).checksum;
            trials.same(format!("{}, {}: checksum", kernel.name, entry.name), &None, &found);
        }
        let about = entry.about.contains("not deterministic");
        trials.holds(format!("{}: what the list says", entry.name), "not deterministic", entry.about, about);
        let Some(sampler) = stateful_sampler(entry.name, 1) else {
            trials.holds(entry.name, "a sampler", "none", false);
            continue;
        };
        let at =
            Address { key: SampleKey { seed: 1, pixel: 0, sample: 0 }, bounce: 0, branch: 0, purpose: Purpose::Film };
        let threads = 8;
        let drawn = on_threads(threads as usize, || (0..draws).map(|_| sampler.pair(at)).collect::<Vec<[f64; 2]>>());
        let all = match drawn {
            Ok(all) => all,
            Err(refused) => {
                trials.skip(format!("{}: {refused}", entry.name));
                continue;
            }
        };
        let numbers = || all.iter().flatten().flatten();
        let outside = numbers().filter(|u| !(0.0..1.0).contains(*u)).count() as u64;
        trials.never(
            format!("{}: 8 threads at once", entry.name),
            "numbers outside of [0, 1)",
            outside,
            2 * threads * draws,
        );
        // Two equal starts of six numbers with 31 bits each: chance never gives them.
        let starts: BTreeSet<Vec<u64>> =
            all.iter().map(|numbers| numbers.iter().take(3).flatten().map(|u| u.to_bits()).collect()).collect();
        if entry.name == SOME_ALIKE {
            continue;
        }
        let different = if entry.name == ALL_ALIKE { 1 } else { threads as usize };
        trials.same(format!("{}: different starts of 8 threads", entry.name), &different, &starts.len());
        if entry.name == ALL_ALIKE {
            continue;
        }
        let n = (2 * threads * draws) as f64;
        let z = (numbers().sum::<f64>() - 0.5 * n) * (12.0 / n).sqrt();
        trials.deviates_below(format!("{}: mean", entry.name), limit, z);
    }
}
