//! Pinned workers run where the setting says, under every strategy.

use crate::watchdog::Watchdog;
use pathmark::Lab;
use pathmark::kernel::workload::{Item, Workload};
use pathmark::machine::{PinPolicy, allowed_cpus};
use pathmark::measure::{Rounds, Settings, Setup};
use pathmark::strategy::{STRATEGIES, Workers};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};
use std::time::Duration;

/// The threads of jobs, and the processors on which they may run.
type Seen = Vec<(ThreadId, Vec<usize>)>;

#[derive(Clone, Default)]
struct Affinity(Arc<Mutex<Seen>>);

impl Workload for Affinity {
    fn run(&self, _: &Item) -> [f64; 3] {
        self.0.lock().unwrap().push((thread::current().id(), allowed_cpus()));
        [1.0; 3]
    }
}

/// Runs the settings and returns the processors of each thread that ran jobs.
fn seen(settings: Settings) -> BTreeMap<String, BTreeSet<Vec<usize>>> {
    seen_in(settings, |setup| drop(setup.run(None).unwrap()))
}

fn seen_in(settings: Settings, run: impl FnOnce(Setup)) -> BTreeMap<String, BTreeSet<Vec<usize>>> {
    let affinity = Affinity::default();
    let lab = Lab::new().workload("affinity", affinity.clone());
    run(lab.prepare(Settings { scene: "affinity".into(), spp: 1, ..settings }).unwrap());
    let mut threads: BTreeMap<String, BTreeSet<Vec<usize>>> = BTreeMap::new();
    for (thread, cpus) in affinity.0.lock().unwrap().iter() {
        threads.entry(format!("{thread:?}")).or_default().insert(cpus.clone());
    }
    threads
}

/// Each thread is alone on one processor in all of its jobs, and the caller is as free afterwards as before.
#[test]
fn workers_of_every_strategy_stay_on_processors_of_their_own() {
    let watchdog = Watchdog::new(Duration::from_secs(20));
    let all = allowed_cpus();
    let cpus: Vec<usize> = all.iter().copied().take(2).collect();
    let pin = PinPolicy::List(cpus.clone());
    for strategy in STRATEGIES {
        watchdog.now(strategy.name);
        let threads = cpus.len();
        let rows = if strategy.workers == Workers::PerJob { threads as u32 } else { 40 };
        let mut settings = Settings { threads, pin: pin.clone(), ..Settings::default() };
        (settings.strategy, settings.decomposition) = (strategy.name.into(), "rows".into());
        (settings.spec.width, settings.spec.height) = (1, rows);
        let threads = seen(settings);
        assert!(threads.values().all(|cpus| cpus.len() == 1), "{}: {threads:?}", strategy.name);
        let places: BTreeSet<usize> = threads.values().flatten().flatten().copied().collect();
        assert_eq!(places.len(), threads.len(), "{}: {threads:?}", strategy.name);
        assert!(places.iter().all(|cpu| cpus.contains(cpu)), "{}: {threads:?}", strategy.name);
        assert_eq!(allowed_cpus(), all, "{}", strategy.name);
    }
}

/// A pool keeps its threads over several rounds, in which they may become other workers.
#[test]
fn pools_are_pinned_in_each_round_and_nobody_without_the_setting() {
    let mut settings = Settings { threads: 1, strategy: "fixed-pool".into(), ..Settings::default() };
    (settings.spec.width, settings.spec.height, settings.spp) = (8, 6, 4);
    let all = allowed_cpus();
    let without = seen(settings.clone());
    assert!(without.values().flatten().all(|cpus| *cpus == all), "{without:?}");
    let last = all[all.len() - 1];
    let pinned = seen_in(Settings { pin: PinPolicy::List(vec![last]), ..settings }, |setup| {
        let mut rounds = Rounds::new(setup).unwrap();
        for spp in [16, 32, 48] {
            rounds.extend_to(spp, None).unwrap();
        }
    });
    assert!(pinned.len() == 1 && pinned.values().flatten().all(|cpus| *cpus == [last]), "{pinned:?}");
}

#[test]
fn impossible_pins_are_refused_before_anything_runs() {
    let refused = |pin: &str, strategy: &str, decomposition: &str| {
        let pin = PinPolicy::parse(pin).unwrap();
        let (strategy, decomposition) = (strategy.into(), decomposition.into());
        let error =
            Setup::prepare(Settings { pin, strategy, decomposition, spp: 4, ..Settings::default() }).err().unwrap();
        assert_eq!(error.exit_code(), 2, "{error}");
        error.to_string()
    };
    let first = allowed_cpus()[0];
    assert!(refused("60000", "serial", "rows").contains("may not run on processor 60000"));
    // A thread for each of 192 rows.
    let error = refused(&first.to_string(), "thread-per-job", "rows");
    assert!(error.contains("only 1 of 192 workers"), "{error}");
}
