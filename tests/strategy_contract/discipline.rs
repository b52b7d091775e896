//! What a strategy says of itself is what it does, as far as that can be seen from outside without luck.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex};
use std::thread::{self, ThreadId};

use pathmark::strategy::{Config, Discipline, STRATEGIES};

use crate::support::{guarded, threads};

#[test]
fn jobs_that_are_dealt_beforehand_run_on_their_workers() {
    const JOBS: usize = 103;
    for entry in STRATEGIES {
        let Discipline::Dealt(deal) = (entry.discipline)(None).unwrap() else { continue };
        for workers in [1, 2, 3, 8] {
            guarded(entry.name, move || {
                let hands = Arc::new(Mutex::new(HashMap::<ThreadId, Vec<usize>>::new()));
                let noted = Arc::clone(&hands);
                let job = move |index| noted.lock().unwrap().entry(thread::current().id()).or_default().push(index);
                (entry.new)(Config::new(threads(workers))).unwrap().run(JOBS, Arc::new(job)).unwrap();
                let found: BTreeSet<Vec<usize>> = hands.lock().unwrap().values().cloned().collect();
                let expected = (0..workers).map(|worker| deal(worker, workers, JOBS).collect()).collect();
                assert_eq!(found, expected, "{}, {workers} threads", entry.name);
            });
        }
    }
}
