//! Stealing: ranges from which workers pop and steal, and the count that shows workers that no job is left.

use std::ops::Range;
use std::sync::Arc;

use crate::panics::Panics;
use crate::ranges::Ranges;
use crate::taken::Taken;
use crate::{Runs, check, team};

const ONE: fn(u32) -> u32 = |_| 1;
const HALF: fn(u32) -> u32 = |left| left.div_ceil(2);

/// Runs workers with these ranges that steal from their neighbours, as `steal-one` and `steal-half` do. A job is
/// recorded and then calls `then`.
fn run(ranges: &[Range<u32>], amount: fn(u32) -> u32, then: impl Fn(usize, &Runs) + Send + Sync + 'static) -> Runs {
    let (workers, jobs) = (ranges.len(), ranges.iter().map(ExactSizeIterator::len).sum());
    let (ranges, taken) = (Ranges::new(ranges.iter().cloned()), Taken::new(jobs, workers));
    let (runs, panics) = (Runs::new(jobs), Panics::default());
    let noted = runs.clone();
    team(workers, move |worker| {
        let steal = || {
            let victims = (worker + 1..worker + ranges.workers()).map(|victim| victim % ranges.workers());
            victims.filter(|&victim| ranges.left(victim) > 0).find_map(|victim| ranges.steal(worker, victim, amount))
        };
        let next = || ranges.pop(worker).or_else(steal).map(|job| job as usize);
        let job = |job| {
            noted.note(job);
            then(job, &noted);
        };
        taken.work(worker, &panics, next, job);
    });
    runs
}

/// Returns the body of a job that ends only if jobs `a` and `b` run at the same time.
fn meet(a: usize, b: usize) -> impl Fn(usize, &Runs) {
    move |job, runs| {
        let other = if job == a { b } else { a };
        while [a, b].contains(&job) && runs.of(other) == 0 {
            loom::thread::yield_now();
        }
    }
}

#[test]
fn an_owner_and_a_thief_share_a_range() {
    for amount in [ONE, HALF] {
        check(move || run(&[0..3, 3..3], amount, |_, _| ()).assert_each_once());
    }
}

#[test]
fn two_workers_rob_each_other() {
    for amount in [ONE, HALF] {
        check(move || run(&[0..2, 2..3], amount, |_, _| ()).assert_each_once());
    }
}

/// Omits the waiting at the end, which is too much for loom with three workers.
#[test]
fn two_thieves_want_the_same_jobs() {
    for amount in [ONE, HALF] {
        check(move || {
            let (ranges, runs) = (Ranges::new([0..2, 2..2, 2..2].into_iter()), Runs::new(2));
            let noted = runs.clone();
            team(3, move |worker| {
                let steal = || if worker == 0 { None } else { ranges.steal(worker, 0, amount) };
                while let Some(job) = ranges.pop(worker).or_else(steal) {
                    noted.note(job as usize);
                }
            });
            runs.assert_each_once();
        });
    }
}

/// The thief steals half of four jobs, begins with job 2 and stays in it until another worker runs job 3. A worker that
/// took the empty ranges for the end would be missing, and the model would not end.
#[test]
fn nobody_leaves_while_a_batch_is_on_its_way() {
    check(|| run(&[0..4, 4..4], HALF, meet(2, 3)).assert_each_once());
}

/// The owner runs job 0 and the thief job 1, and each job waits until the other has begun.
#[test]
fn owner_and_thief_can_work_at_the_same_time() {
    check(|| run(&[0..2, 2..2], HALF, meet(0, 1)).assert_each_once());
}

#[test]
fn a_wish_to_stop_ends_the_wait_for_jobs_that_never_come() {
    check(|| {
        let (taken, panics) = (Arc::new(Taken::new(1, 2)), Arc::new(Panics::default()));
        team(2, move |worker| {
            if worker == 0 {
                panics.ask_to_stop();
            }
            taken.work(worker, &panics, || None, |job| panic!("there is no job {job}"));
        });
    });
}
