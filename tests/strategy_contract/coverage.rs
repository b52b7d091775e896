//! Each index exactly once, however many jobs and threads there are, and however often a strategy is used.

use std::sync::Arc;

use pathmark::strategy::{Config, Job, STRATEGIES, find};

use crate::support::{Runs, TestSpawner, guarded, threads};

#[test]
fn each_index_runs_exactly_once() {
    for entry in STRATEGIES {
        for workers in [1, 2, 3, 8] {
            for jobs in [0, 1, workers - 1, workers, workers + 1, 1000] {
                let what = format!("{}, {workers} threads, {jobs} jobs", entry.name);
                let case = what.clone();
                guarded(&what, move || {
                    let runs = Runs::new(jobs);
                    (entry.new)(Config::new(threads(workers))).unwrap().run(jobs, runs.job()).unwrap();
                    assert!(runs.each_once(), "{case}: {:?}", runs.counts());
                });
            }
        }
    }
}

/// Every parameter that a strategy's documentation names.
const PARAMETERS: &[(&str, &[&str])] = &[
    ("dynamic", &["1", "2", "7", "5000"]),
    ("steal-one", &["neighbour", "random", "richest"]),
    ("steal-half", &["neighbour", "random", "richest"]),
    #[cfg(feature = "openmp")]
    ("openmp-dynamic", &["1", "2", "7", "5000"]),
    #[cfg(feature = "openmp")]
    ("openmp-guided", &["1", "2", "7", "5000"]),
];

#[test]
fn each_index_runs_exactly_once_whatever_the_parameter() {
    for &(name, parameters) in PARAMETERS {
        for &parameter in parameters {
            for (workers, jobs) in [(1, 100), (2, 1000), (3, 2), (3, 1000), (8, 1000)] {
                let what = format!("{name}:{parameter}, {workers} threads, {jobs} jobs");
                let case = what.clone();
                guarded(&what, move || {
                    let parameter = Some(parameter.to_owned());
                    let config = Config { parameter, ..Config::new(threads(workers)) };
                    let mut strategy = (find(name).unwrap().new)(config).unwrap();
                    for _ in 0..10 {
                        let runs = Runs::new(jobs);
                        strategy.run(jobs, runs.job()).unwrap();
                        assert!(runs.each_once(), "{case}: {:?}", runs.counts());
                    }
                });
            }
        }
    }
}

#[test]
fn one_object_serves_many_runs() {
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let mut strategy = (entry.new)(Config::new(threads(3))).unwrap();
            for jobs in [100, 0, 2, 7, 100] {
                let runs = Runs::new(jobs);
                strategy.run(jobs, runs.job()).unwrap();
                assert!(runs.each_once(), "{}: {:?}", entry.name, runs.counts());
            }
        });
    }
}

#[test]
fn more_jobs_than_any_queue_holds() {
    // Past the room in a bounded channel, the blocks of an unbounded one and the first buffer of a deque.
    const JOBS: usize = 20_000;
    for entry in STRATEGIES.iter().filter(|entry| entry.workers.at_once(2, JOBS) < JOBS) {
        guarded(entry.name, || {
            let runs = Runs::new(JOBS);
            (entry.new)(Config::new(threads(2))).unwrap().run(JOBS, runs.job()).unwrap();
            assert!(runs.each_once(), "{}", entry.name);
        });
    }
}

#[test]
fn no_clone_of_the_job_is_left_when_run_returns() {
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let mut strategy = (entry.new)(Config::new(threads(3))).unwrap();
            let job: Job = Arc::new(|_| ());
            strategy.run(50, Arc::clone(&job)).unwrap();
            assert_eq!(Arc::strong_count(&job), 1, "{} still holds the job", entry.name);
        });
    }
}

#[test]
fn no_thread_is_left_when_a_strategy_is_dropped() {
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let spawner = TestSpawner::unlimited();
            let mut strategy = (entry.new)(spawner.config(threads(3))).unwrap();
            strategy.run(10, Runs::new(10).job()).unwrap();
            drop(strategy);
            assert_eq!(spawner.alive(), 0, "{}", entry.name);
            // Made and never used.
            drop((entry.new)(spawner.config(threads(3))).unwrap());
            assert_eq!(spawner.alive(), 0, "{}, unused", entry.name);
        });
    }
}
