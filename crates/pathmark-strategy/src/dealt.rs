//! Strategies whose workers know their jobs before they start, from a [`Deal`](crate::Deal).

use std::sync::Arc;

use crate::panics::Panics;
use crate::{Blueprint, Discipline, Job, StrategyError, team};

pub(crate) fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let Discipline::Dealt(deal) = blueprint.discipline else {
        unreachable!("{} hands out jobs by {:?}", blueprint.strategy, blueprint.discipline)
    };
    let workers = blueprint.workers(jobs);
    let bodies = (0..workers).map(|worker| {
        let job = Arc::clone(job);
        let mine = deal(worker, workers, jobs);
        move |panics: &Panics| {
            for index in mine {
                if panics.stop_asked() {
                    break;
                }
                job(index);
            }
        }
    });
    team::run(&*blueprint.spawner, bodies)
}
