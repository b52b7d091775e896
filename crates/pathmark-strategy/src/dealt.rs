//! Strategies whose workers know their jobs before they start, from a [`Deal`](crate::Deal).

use std::sync::Arc;

use crate::panics::Panics;
use crate::{Blueprint, Deal, Discipline, Job, Strategy, StrategyError, team};

/// Makes a strategy whose discipline is a deal.
pub(crate) fn make(blueprint: &Blueprint) -> Result<Box<dyn Strategy>, StrategyError> {
    match blueprint.discipline {
        Discipline::Dealt(deal) => Ok(Box::new(Dealt { blueprint: blueprint.clone(), deal })),
        other => unreachable!("{} hands out jobs by {other:?}", blueprint.strategy),
    }
}

struct Dealt {
    blueprint: Blueprint,
    deal: Deal,
}

impl Strategy for Dealt {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let workers = self.blueprint.threads.get().min(jobs);
        let bodies = (0..workers).map(|worker| {
            let job = Arc::clone(&job);
            let mine = (self.deal)(worker, workers, jobs);
            move |panics: &Panics| {
                for index in mine {
                    if panics.stop_asked() {
                        break;
                    }
                    job(index);
                }
            }
        });
        team::run(&*self.blueprint.spawner, bodies)
    }
}
