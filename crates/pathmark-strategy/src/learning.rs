//! Strategies that learn the speeds of their workers: a free worker reports the times of its last chunk and gets the
//! next one, whose size follows a [`LearnedRule`].

use std::ops::Range;
use std::sync::{Arc, PoisonError};
use std::time::Instant;

use crate::ledger::{Clock, LearnedRule, Ledger, Seen};
use crate::panics::Panics;
use crate::sync::Mutex;
use crate::{Blueprint, Discipline, Job, StrategyError, team};

pub(crate) fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let Discipline::Learned(rule) = blueprint.discipline else {
        unreachable!("{} hands out jobs by {:?}", blueprint.strategy, blueprint.discipline)
    };
    let workers = blueprint.workers(jobs);
    let ledger = Arc::new(Mutex::new(Ledger::new(jobs, workers, rule.weights)));
    let bodies = (0..workers).map(|worker| {
        let (job, ledger) = (Arc::clone(job), Arc::clone(&ledger));
        move |panics: &Panics| {
            let mut seen = Seen::default();
            while !panics.stop_asked() {
                let Some(chunk) = next(&ledger, rule, worker, seen) else { break };
                seen = match rule.clock {
                    Clock::Chunks => timed_whole(chunk, panics, &*job),
                    Clock::Jobs => timed_each(chunk, panics, &*job),
                };
            }
        }
    });
    team::run(&*blueprint.spawner, bodies)
}

/// Returns the next chunk. The lock is released on return, so no job runs under it.
fn next(ledger: &Mutex<Ledger>, rule: LearnedRule, worker: usize, seen: Seen) -> Option<Range<usize>> {
    // A rule from another crate may panic here, which stops the run. The ledger stays valid, so workers that still ask
    // need not panic, too.
    let mut ledger = ledger.lock().unwrap_or_else(PoisonError::into_inner);
    ledger.note(worker, seen);
    rule.next(&mut ledger, worker)
}

fn timed_whole(chunk: Range<usize>, panics: &Panics, job: &dyn Fn(usize)) -> Seen {
    let (begin, jobs) = (Instant::now(), chunk.len());
    for index in chunk {
        if panics.stop_asked() {
            break;
        }
        job(index);
    }
    Seen { jobs, seconds: begin.elapsed().as_secs_f64(), squares: 0.0 }
}

fn timed_each(chunk: Range<usize>, panics: &Panics, job: &dyn Fn(usize)) -> Seen {
    let (mut seen, mut begin) = (Seen::default(), Instant::now());
    for index in chunk {
        if panics.stop_asked() {
            break;
        }
        job(index);
        let end = Instant::now();
        seen.add(end.duration_since(begin).as_secs_f64());
        begin = end;
    }
    seen
}
