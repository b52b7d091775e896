//! Range stealing, the common part of `steal-one` and `steal-half`: each worker begins with a block of jobs. A worker
//! without jobs steals from the end of another worker's block.

use std::cmp::Reverse;
use std::ops::Range;
use std::sync::Arc;

use rand::Rng;
use rand_pcg::Pcg32;

use super::static_blocks::block;
use crate::panics::Panics;
use crate::ranges::Ranges;
use crate::taken::Taken;
use crate::{
    Amount, Blueprint, Discipline, Entry, Job, Parameter, Start, Stealing, StrategyError, Victim, each_run, team,
};

/// The texts allowed after the colon.
const VICTIMS: [(&str, Victim); 3] =
    [("neighbour", Victim::Neighbour), ("random", Victim::Random), ("richest", Victim::Richest)];

/// Largest number of jobs: a job's number has half of a 64-bit word.
const MOST: usize = u32::MAX as usize;

/// Returns the entry of a strategy that steals `amount`; `read` is its [`discipline`] for the victim that the user
/// names.
pub(super) const fn entry(
    name: &'static str,
    about: &'static str,
    amount: Amount,
    read: fn(&str) -> Option<Discipline>,
) -> Entry {
    let stealing = Stealing { start: Start::Blocks, amount, victim: Victim::Neighbour };
    Entry {
        parameter: Some(Parameter { allowed: "neighbour, random, richest", read }),
        ..Entry::new(name, about, Discipline::Stealing(stealing), |blueprint| each_run(blueprint, run))
    }
}

/// Returns the discipline that steals `amount` from `victim`; `None` if there is no such victim.
pub(super) fn discipline(amount: Amount, victim: &str) -> Option<Discipline> {
    let &(_, victim) = VICTIMS.iter().find(|(known, _)| *known == victim)?;
    Some(Discipline::Stealing(Stealing { start: Start::Blocks, amount, victim }))
}

fn run(blueprint: &Blueprint, jobs: usize, job: &Job) -> Result<(), StrategyError> {
    let Discipline::Stealing(Stealing { amount, victim, .. }) = blueprint.discipline else {
        unreachable!("{} hands out jobs by {:?}", blueprint.strategy, blueprint.discipline)
    };
    if jobs > MOST {
        return Err(StrategyError::TooManyJobs { strategy: blueprint.strategy, jobs, most: MOST });
    }
    let workers = blueprint.workers(jobs);
    let blocks = (0..workers).map(|worker| {
        let Range { start, end } = block(worker, workers, jobs);
        start as u32..end as u32
    });
    let shared = Arc::new((Ranges::new(blocks), Taken::new(jobs, workers)));
    let bodies = (0..workers).map(|worker| {
        let (job, shared) = (Arc::clone(job), Arc::clone(&shared));
        move |panics: &Panics| {
            let (ranges, taken) = &*shared;
            let mut thief = Thief::new(worker, amount, victim);
            let next = || ranges.pop(worker).or_else(|| thief.steal(ranges)).map(|index| index as usize);
            taken.work(worker, panics, next, &*job);
        }
    });
    team::run(&*blueprint.spawner, bodies)
}

/// A worker whose own range is empty.
struct Thief {
    worker: usize,
    amount: Amount,
    victim: Victim,
    /// Its stream is the worker's number, so random victims depend neither on the clock nor on outside randomness.
    random: Pcg32,
}

impl Thief {
    fn new(worker: usize, amount: Amount, victim: Victim) -> Self {
        Self { worker, amount, victim, random: Pcg32::new(0, worker as u64) }
    }

    /// Steals from another worker and returns one job. The other stolen jobs are in this worker's range afterwards.
    /// `None` if no worker had a job when asked.
    fn steal(&mut self, ranges: &Ranges) -> Option<u32> {
        let workers = ranges.workers();
        let thief = self.worker;
        let amount = match self.amount {
            Amount::One => |_| 1,
            Amount::Half => |left: u32| left.div_ceil(2),
        };
        let first = match self.victim {
            Victim::Neighbour => thief + 1,
            // The product's high half is below the number of workers.
            Victim::Random => ((u64::from(self.random.next_u32()) * workers as u64) >> 32) as usize,
            // The first of equals. If it has lost its jobs meanwhile, the search goes on with its neighbour.
            Victim::Richest => (0..workers).max_by_key(|&worker| (ranges.left(worker), Reverse(worker)))?,
        };
        let mut victims = (first..first + workers).map(|worker| worker % workers).filter(|&victim| victim != thief);
        victims.find_map(|victim| ranges.steal(thief, victim, amount))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Config, find};
    use std::num::NonZeroUsize;

    /// Worker 0 has no job, 1 has one, 2 has none, 3 has four and 4 has two.
    fn ranges() -> Ranges {
        Ranges::new([0..0, 0..1, 1..1, 1..5, 5..7].into_iter())
    }

    fn stolen(worker: usize, amount: Amount, victim: Victim, ranges: &Ranges) -> Option<u32> {
        Thief::new(worker, amount, victim).steal(ranges)
    }

    #[test]
    fn a_thief_takes_the_last_job_or_the_upper_half() {
        let from = ranges();
        assert_eq!(stolen(2, Amount::One, Victim::Neighbour, &from), Some(4));
        assert_eq!([2, 3].map(|worker| from.left(worker)), [0, 3]);
        // Half of three is two: job 2 is returned, job 3 is in the thief's range.
        assert_eq!(stolen(2, Amount::Half, Victim::Neighbour, &from), Some(2));
        assert_eq!([2, 3].map(|worker| from.left(worker)), [1, 1]);
        assert_eq!((from.pop(2), from.pop(2), from.pop(3), from.pop(3)), (Some(3), None, Some(1), None));
    }

    #[test]
    fn the_victim_is_the_one_that_was_asked_for() {
        assert_eq!(stolen(0, Amount::One, Victim::Neighbour, &ranges()), Some(0));
        assert_eq!(stolen(0, Amount::One, Victim::Richest, &ranges()), Some(4));
        // Some random start leads to each of the workers 1, 3 and 4.
        let mut thief = Thief::new(0, Amount::One, Victim::Random);
        let mut seen: Vec<_> = (0..50).filter_map(|_| thief.steal(&ranges())).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen, [0, 4, 6]);
        let empty = Ranges::new([0..0, 0..0].into_iter());
        assert!(
            [Victim::Neighbour, Victim::Random, Victim::Richest].map(|v| stolen(0, Amount::Half, v, &empty))
                == [None; 3]
        );
    }

    #[test]
    fn of_equally_rich_victims_the_first_is_asked() {
        let from = Ranges::new([0..0, 0..2, 2..4].into_iter());
        assert_eq!(stolen(0, Amount::One, Victim::Richest, &from), Some(1));
    }

    #[test]
    fn more_jobs_than_a_word_can_number_are_refused() {
        for name in ["steal-one", "steal-half"] {
            let mut strategy = find(name).unwrap().build(Config::new(NonZeroUsize::MIN)).unwrap();
            let error = strategy.run(MOST + 1, Arc::new(|_| panic!("nothing may run"))).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("strategy {name}: 4294967296 jobs are too many (allowed: 0 to 4294967295)")
            );
        }
    }
}
