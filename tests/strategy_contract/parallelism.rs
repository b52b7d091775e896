//! As many jobs at a time as there are workers: no fewer, and no more.

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;

use pathmark::strategy::{Config, Entry, STRATEGIES, Threads, Workers};

use crate::meeting::{self, Meeting};
use crate::support::{Runs, TestSpawner, guarded, threads};

/// Every entry with the numbers of threads that it can be asked for.
fn cases() -> impl Iterator<Item = (&'static Entry, usize)> {
    let workers = |entry: &Entry| if entry.workers == Workers::Caller { &[1][..] } else { &[1, 2, 3, 8][..] };
    STRATEGIES.iter().flat_map(move |entry| workers(entry).iter().map(move |&workers| (entry, workers)))
}

#[test]
fn all_workers_meet_at_a_barrier() {
    // Many rounds, because a worker that leaves too early does so in a gap of nanoseconds.
    for (entry, workers) in cases() {
        let what = format!("{}, {workers} threads", entry.name);
        guarded(&what, move || {
            let mut strategy = (entry.new)(Config::new(threads(workers))).unwrap();
            for &jobs in meeting::jobs(entry, workers).iter().cycle().take(100) {
                let meeting = Arc::new(Meeting::new(entry, workers));
                let place = Arc::clone(&meeting);
                strategy.run(jobs, Arc::new(move |_| place.wait())).unwrap();
                assert!(meeting.met(), "{}, {workers} threads", entry.name);
            }
        });
    }
}

#[test]
fn jobs_run_on_the_asked_number_of_threads() {
    for (entry, workers) in cases() {
        let what = format!("{}, {workers} threads", entry.name);
        let case = what.clone();
        guarded(&what, move || {
            let jobs = meeting::jobs(entry, workers).into_iter().max().unwrap();
            let expected = entry.workers.at_once(workers, jobs);
            let meeting = Meeting::new(entry, workers);
            let seen = Arc::new(Mutex::new(HashSet::new()));
            let (running, most) = (AtomicUsize::new(0), Arc::new(AtomicUsize::new(0)));
            let (ids, peak) = (Arc::clone(&seen), Arc::clone(&most));
            let job = move |_| {
                ids.lock().unwrap().insert(thread::current().id());
                peak.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                meeting.wait();
                running.fetch_sub(1, Ordering::SeqCst);
            };
            (entry.new)(Config::new(threads(workers))).unwrap().run(jobs, Arc::new(job)).unwrap();
            let seen = seen.lock().unwrap();
            assert_eq!(seen.len(), expected, "{case}");
            let most = most.load(Ordering::SeqCst);
            assert!((workers..=expected).contains(&most), "{case}: {most} at a time");
            assert_eq!(seen.contains(&thread::current().id()), entry.workers == Workers::Caller, "{case}: the caller");
        });
    }
}

#[test]
fn threads_come_from_the_spawner_and_never_exceed_the_jobs_or_the_asked() {
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let spawner = TestSpawner::unlimited();
            let mut strategy = (entry.new)(spawner.config(threads(8))).unwrap();
            let pool = spawner.asked();
            let of_a_pool = if entry.threads == Threads::Library { &[1][..] } else { &[0, 8] };
            assert!(of_a_pool.contains(&pool), "{}: {pool} threads in the pool", entry.name);
            strategy.run(3, Runs::new(3).job()).unwrap();
            let caller = usize::from(entry.workers == Workers::Caller);
            let per_run = if pool == 0 { entry.workers.at_once(8, 3) - caller } else { 0 };
            assert_eq!(spawner.asked() - pool, per_run, "{}", entry.name);
        });
    }
}
