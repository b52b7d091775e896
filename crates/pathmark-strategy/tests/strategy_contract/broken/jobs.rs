//! Faults of jobs, panics and clones in a run.

use std::panic::{self, AssertUnwindSafe};
use std::sync::{Arc, Mutex};
use std::thread;

use pathmark_strategy::contract::Promise;

use super::{Fault, runs};

pub(super) const FAULTS: &[Fault] = &[
    (
        "the last job is lost",
        Promise::EachJobOnce,
        runs!(|broken, jobs, job| broken.inner.run(jobs.saturating_sub(1), job)),
    ),
    (
        "the first job runs twice",
        Promise::EachJobOnce,
        runs!(|broken, jobs, job| {
            let twice = move |index| (0..=usize::from(index == 0)).for_each(|_| job(index));
            broken.inner.run(jobs, Arc::new(twice))
        }),
    ),
    ("there is a job too many", Promise::EachJobOnce, runs!(|broken, jobs, job| broken.inner.run(jobs + 1, job))),
    (
        "no jobs are a failure",
        Promise::EachJobOnce,
        runs!(|broken, jobs, job| {
            assert!(jobs > 0, "a job is needed");
            broken.inner.run(jobs, job)
        }),
    ),
    (
        "more threads than jobs are a failure",
        Promise::EachJobOnce,
        runs!(|broken, jobs, job| {
            assert!(jobs == 0 || jobs >= broken.blueprint.threads.get(), "a job for each worker is needed");
            broken.inner.run(jobs, job)
        }),
    ),
    (
        "a second run does nothing",
        Promise::EachJobOnce,
        runs!(|broken, jobs, job| {
            let first = !std::mem::replace(&mut broken.panicked, true);
            if first { broken.inner.run(jobs, job) } else { Ok(()) }
        }),
    ),
    (
        "it returns before its jobs have ended",
        Promise::End,
        runs!(|_, jobs, job| {
            thread::spawn(move || (0..jobs).for_each(|index| job(index)));
            Ok(())
        }),
    ),
    (
        "more than a hundred jobs never end",
        Promise::End,
        runs!(|broken, jobs, job| {
            if jobs > 100 {
                loop {
                    thread::park();
                }
            }
            broken.inner.run(jobs, job)
        }),
    ),
    (
        "a panic is swallowed",
        Promise::Panics,
        runs!(|broken, jobs, job| {
            let run = AssertUnwindSafe(|| broken.inner.run(jobs, job));
            panic::catch_unwind(run).unwrap_or(Ok(()))
        }),
    ),
    (
        "another panic is raised",
        Promise::Panics,
        runs!(|broken, jobs, job| {
            let run = AssertUnwindSafe(|| broken.inner.run(jobs, job));
            panic::catch_unwind(run).unwrap_or_else(|payload| {
                std::mem::forget(payload);
                panic::resume_unwind(Box::new("a job panicked"))
            })
        }),
    ),
    (
        "it does nothing after a panic",
        Promise::Panics,
        runs!(|broken, jobs, job| {
            if broken.panicked {
                return Ok(());
            }
            broken.panicked = true;
            let outcome = broken.inner.run(jobs, job);
            broken.panicked = false;
            outcome
        }),
    ),
    (
        "the other jobs run all the same",
        Promise::Stopping,
        runs!(|broken, jobs, job| {
            let first = Arc::new(Mutex::new(None));
            let kept = Arc::clone(&first);
            let carry_on = move |index| {
                let run = AssertUnwindSafe(|| job(index));
                if let Err(payload) = panic::catch_unwind(run) {
                    std::mem::forget(kept.lock().unwrap().replace(payload));
                }
            };
            broken.inner.run(jobs, Arc::new(carry_on))?;
            let payload = first.lock().unwrap().take();
            payload.map_or(Ok(()), |payload| panic::resume_unwind(payload))
        }),
    ),
    (
        "a clone of the job is kept",
        Promise::NoJobLeft,
        runs!(|broken, jobs, job| {
            broken.kept.push(Arc::clone(&job));
            broken.inner.run(jobs, job)
        }),
    ),
];
