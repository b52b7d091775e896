//! A panic in a job reaches the caller as it was thrown, stops the others, and leaves nothing behind.

use std::any::Any;
use std::mem;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pathmark::strategy::{Config, Job, STRATEGIES, Strategy, Workers};

use crate::meeting::Meeting;
use crate::support::{Runs, TestSpawner, guarded, threads};

fn thrown_by(strategy: &mut dyn Strategy, jobs: usize, job: Job) -> Box<dyn Any + Send> {
    panic::catch_unwind(AssertUnwindSafe(|| strategy.run(jobs, job))).expect_err("the panic reaches the caller")
}

#[test]
fn a_message_reaches_the_caller_and_the_object_works_again() {
    const JOBS: usize = 20;
    for entry in STRATEGIES {
        for workers in [1, 3] {
            for culprit in [0, JOBS / 2, JOBS - 1] {
                let what = format!("{}, {workers} threads, job {culprit}", entry.name);
                let case = what.clone();
                guarded(&what, move || {
                    let spawner = TestSpawner::unlimited();
                    let mut strategy = (entry.new)(spawner.config(threads(workers))).unwrap();
                    let runs = Runs::new(JOBS);
                    let noted = runs.clone();
                    let job = move |index| {
                        noted.note(index);
                        assert!(index != culprit, "job {index} fails");
                    };
                    let payload = thrown_by(&mut *strategy, JOBS, Arc::new(job));
                    assert_eq!(payload.downcast_ref::<String>(), Some(&format!("job {culprit} fails")), "{case}");
                    assert!(runs.none_twice() && runs.counts()[culprit] == 1, "{case}: {:?}", runs.counts());

                    let again = Runs::new(JOBS);
                    strategy.run(JOBS, again.job()).unwrap();
                    assert!(again.each_once(), "{case}: {:?}", again.counts());
                    drop(strategy);
                    assert_eq!(spawner.alive(), 0, "{case}");
                });
            }
        }
    }
}

#[test]
fn any_payload_of_any_job_reaches_the_caller() {
    #[derive(Debug, PartialEq)]
    struct Odd(usize);
    const JOBS: usize = 40;
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let spawner = TestSpawner::unlimited();
            let mut strategy = (entry.new)(spawner.config(threads(3))).unwrap();
            for culprit in 0..JOBS {
                let job = move |index| {
                    if index == culprit {
                        // As `panic_any`, without a report on stderr for each.
                        panic::resume_unwind(Box::new(Odd(index)));
                    }
                };
                let payload = thrown_by(&mut *strategy, JOBS, Arc::new(job));
                assert_eq!(payload.downcast_ref::<Odd>(), Some(&Odd(culprit)), "{}", entry.name);
            }
            drop(strategy);
            assert_eq!(spawner.alive(), 0, "{}", entry.name);
        });
    }
}

#[test]
fn when_all_workers_panic_one_payload_arrives_and_the_object_works_again() {
    // Whoever drops it panics, and a worker of a pool that did so would be missing in the next run.
    struct Spiteful;
    impl Drop for Spiteful {
        fn drop(&mut self) {
            panic::resume_unwind(Box::new("dropped"));
        }
    }
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let mut strategy = (entry.new)(Config::new(threads(3))).unwrap();
            for _ in 0..20 {
                let workers = entry.workers.at_once(3, 3);
                let meeting = Meeting::new(entry, workers);
                let job = move |_| {
                    meeting.wait();
                    panic::resume_unwind(Box::new(Spiteful));
                };
                let payload = thrown_by(&mut *strategy, workers, Arc::new(job));
                let arrived = payload.is::<Spiteful>();
                // Before anything that can fail: dropped while unwinding, it would end the whole test program.
                mem::forget(payload);
                assert!(arrived, "{}", entry.name);
                let again = Runs::new(30);
                strategy.run(30, again.job()).unwrap();
                assert!(again.each_once(), "{}: {:?}", entry.name, again.counts());
            }
        });
    }
}

#[test]
fn after_a_panic_a_lone_worker_starts_no_job() {
    for entry in STRATEGIES.iter().filter(|entry| entry.workers != Workers::PerJob) {
        guarded(entry.name, || {
            let late = Runs::new(1);
            let (noted, thrown) = (late.clone(), AtomicBool::new(false));
            let job = move |index| {
                if thrown.load(Ordering::SeqCst) {
                    noted.note(0);
                }
                if index == 10 {
                    thrown.store(true, Ordering::SeqCst);
                    panic::resume_unwind(Box::new(()));
                }
            };
            thrown_by(&mut *(entry.new)(Config::new(threads(1))).unwrap(), 10_000, Arc::new(job));
            assert_eq!(late.started(), 0, "{}", entry.name);
        });
    }
}

#[test]
fn after_a_panic_the_other_workers_stop_early() {
    // Job 0 throws; every other one waits until it has begun and then for 1 ms. A worker that went on to the end would run
    // half of the jobs, one that stops has a whole second to notice.
    const JOBS: usize = 2000;
    for entry in STRATEGIES.iter().filter(|entry| entry.workers == Workers::Threads) {
        guarded(entry.name, || {
            let runs = Runs::new(JOBS);
            let (noted, begun) = (runs.clone(), AtomicBool::new(false));
            let job = move |index| {
                noted.note(index);
                if index == 0 {
                    begun.store(true, Ordering::SeqCst);
                    panic::resume_unwind(Box::new(()));
                }
                while !begun.load(Ordering::SeqCst) {
                    thread::sleep(Duration::from_millis(1));
                }
                thread::sleep(Duration::from_millis(1));
            };
            thrown_by(&mut *(entry.new)(Config::new(threads(2))).unwrap(), JOBS, Arc::new(job));
            assert!(runs.started() < JOBS / 2, "{}: {} jobs", entry.name, runs.started());
        });
    }
}
