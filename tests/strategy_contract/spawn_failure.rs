//! F06: when the system gives no more threads, whichever it refuses first: an error that says which, or fewer workers; never a hang, a lost
//! job, or a job twice.

use pathmark::strategy::{Entry, STRATEGIES, StrategyError, Threads, Workers};

use crate::support::{Runs, TestSpawner, guarded, threads};

const THREADS: usize = 8;

#[test]
fn an_error_or_fewer_workers() {
    for entry in STRATEGIES {
        for jobs in [THREADS, 100] {
            let workers = entry.workers.at_once(THREADS, jobs);
            for refused in 0..workers {
                // One refusal, or no thread ever again.
                for until in [refused + 1, usize::MAX] {
                    let what = format!("{}, {jobs} jobs, threads {refused}..{until} refused", entry.name);
                    let case = what.clone();
                    guarded(&what, move || {
                        let spawner = TestSpawner::failing(refused, until);
                        let runs = Runs::new(jobs);
                        let outcome = (entry.new)(spawner.config(threads(THREADS)))
                            .and_then(|mut strategy| strategy.run(jobs, runs.job()));
                        // Of a library's strategy one thread comes from here; the others can't be refused here.
                        if entry.threads == Threads::Library {
                            assert_eq!(outcome.is_err(), refused == 0, "{case}");
                        }
                        match outcome {
                            Ok(()) => assert!(runs.each_once(), "{case}: {:?}", runs.counts()),
                            Err(error) => {
                                assert!(runs.none_twice(), "{case}: {:?}", runs.counts());
                                assert_names_the_worker(&error, refused + 1, workers);
                            }
                        }
                        assert_eq!(spawner.alive(), 0, "{case}");
                    });
                }
            }
        }
    }
}

fn assert_names_the_worker(error: &StrategyError, number: usize, of: usize) {
    let StrategyError::Spawn { worker, workers, source } = error else { panic!("{error}") };
    assert_eq!((*worker, *workers, source.kind()), (number, of, std::io::ErrorKind::WouldBlock), "{error}");
    assert!(error.to_string().starts_with(&format!("starting worker {number} of {of}: ")), "{error}");
}

#[test]
fn a_strategy_that_starts_threads_in_each_run_recovers() {
    // A library's strategy asks for one thread only, and in the construction.
    let several = |entry: &&Entry| entry.workers != Workers::Caller && entry.threads == Threads::Spawner;
    for entry in STRATEGIES.iter().filter(several) {
        guarded(entry.name, || {
            let spawner = TestSpawner::failing(1, 2);
            // A pool has failed already.
            let Ok(mut strategy) = (entry.new)(spawner.config(threads(THREADS))) else { return };
            let error = strategy.run(THREADS, Runs::new(THREADS).job());
            assert!(error.is_err(), "{}", entry.name);
            let runs = Runs::new(THREADS);
            strategy.run(THREADS, runs.job()).unwrap();
            assert!(runs.each_once(), "{}: {:?}", entry.name, runs.counts());
        });
    }
}
