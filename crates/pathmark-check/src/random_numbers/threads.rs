//! Independence of the threads that draw random numbers; samplers that lack it are flagged: R08, R12.

use crate::kernel::{KERNELS, Spec};
use crate::measure::{Settings, Setup};
use crate::run::on_threads;
use crate::sampling::{Address, Purpose, SAMPLERS, SampleKey, stateful_sampler};
use crate::scene::{Scene, load};
use crate::strategy::STRATEGIES;
use crate::{Trials, critical};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The checksum of a small image, if it has one.
fn checksum(
    scene: &Arc<Scene>,
    kernel: &str,
    sampler: &str,
    strategy: &str,
    threads: usize,
) -> Result<Option<String>, String> {
    let spec = Spec { width: 12, height: 9, kernel: kernel.into(), sampler: sampler.into(), ..Spec::default() };
    let (decomposition, strategy) = ("tiles:4x4".to_string(), strategy.to_string());
    let settings = Settings { spp: 4, spec, decomposition, strategy, threads, ..Settings::default() };
    let outcome = Setup::for_scene(Arc::clone(scene), settings).and_then(|setup| setup.run(None));
    outcome.map(|outcome| outcome.checksum).map_err(|error| error.to_string())
}

pub(super) fn one_checksum(trials: &mut Trials) {
    let scene = Arc::new(load("cornell").expect("a shipped scene"));
    let threads: &[usize] = if trials.times(0, 1) == 0 { &[1, 2, 5] } else { &[1, 2, 3, 4, 5, 7, 8, 16, 64] };
    for kernel in KERNELS {
        for sampler in SAMPLERS.iter().filter(|entry| entry.deterministic) {
            let right = checksum(&scene, kernel.name, sampler.name, "serial", 1);
            let is_there = right.as_ref().is_ok_and(Option::is_some);
            let variant = format!("{}, {}", kernel.name, sampler.name);
            trials.holds(format!("{variant}, serial"), "a checksum", format!("{right:?}"), is_there);
            for strategy in STRATEGIES {
                let found: Vec<_> =
                    threads.iter().map(|n| checksum(&scene, kernel.name, sampler.name, strategy.name, *n)).collect();
                let wrong = found.iter().find(|found| **found != right).unwrap_or(&right);
                trials.same(format!("{variant}, {}, threads {threads:?}", strategy.name), &right, wrong);
            }
        }
    }
}

/// Samplers that give equal numbers to several threads, wrong on purpose: all threads start alike, or some may.
const ALL_ALIKE: &str = "same-seed";
const SOME_ALIKE: &str = "racy";

/// The table flags these samplers, and their images have no checksum. Eight threads that draw at once get numbers in
/// [0, 1) with mean 1/2, and no two threads draw the same sequence, unless the sampler is there to show that error.
pub(super) fn shared(trials: &mut Trials) {
    let scene = Arc::new(load("cornell").expect("a shipped scene"));
    let stateful = || SAMPLERS.iter().filter(|entry| !entry.deterministic);
    let limit = critical(stateful().count());
    let draws = trials.times(20_000, 2_000_000);
    for entry in stateful() {
        for kernel in KERNELS {
            let found = checksum(&scene, kernel.name, entry.name, "shared-counter", 2);
            trials.same(format!("{}, {}: checksum", kernel.name, entry.name), &Ok(None), &found);
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
