//! What `steal-one` and `steal-half` share: each worker begins with its block of the jobs, and whoever has none left steals from another
//! worker's end.

use std::ops::Range;
use std::sync::Arc;

use super::panics::Panics;
use super::ranges::Ranges;
use super::taken::Taken;
use super::{
    Amount, Config, Discipline, Entry, Job, Start, Stealing, Strategy, StrategyError, Victim, static_blocks, team,
};

/// What may follow the colon.
const VICTIMS: [(&str, Victim); 3] =
    [("neighbour", Victim::Neighbour), ("random", Victim::Random), ("richest", Victim::Richest)];

/// A job's number has half of a 64-bit word.
const MOST: usize = u32::MAX as usize;

/// The discipline of stealing so much, from whom the parameter says.
pub(super) fn discipline(
    strategy: &'static str,
    amount: Amount,
    parameter: Option<&str>,
) -> Result<Discipline, StrategyError> {
    let name = parameter.unwrap_or("neighbour");
    match VICTIMS.iter().find(|(known, _)| *known == name) {
        Some(&(_, victim)) => Ok(Discipline::Stealing(Stealing { start: Start::Blocks, amount, victim })),
        None => Err(StrategyError::Parameter {
            strategy,
            value: name.to_owned(),
            allowed: VICTIMS.map(|(name, _)| name).join(", "),
        }),
    }
}

/// The strategy of an entry whose discipline is stealing from blocks.
pub(super) fn new(config: Config, entry: &Entry) -> Result<Box<dyn Strategy>, StrategyError> {
    match config.discipline(entry)? {
        Discipline::Stealing(stealing) => Ok(Box::new(RangeStealing { name: entry.name, config, stealing })),
        other => unreachable!("{} hands out jobs by {other:?}", entry.name),
    }
}

struct RangeStealing {
    name: &'static str,
    config: Config,
    stealing: Stealing,
}

impl Strategy for RangeStealing {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        if jobs > MOST {
            return Err(StrategyError::TooManyJobs { strategy: self.name, jobs, most: MOST });
        }
        let workers = self.config.threads.get().min(jobs);
        let blocks = (0..workers).map(|worker| {
            let Range { start, end } = static_blocks::block(worker, workers, jobs);
            start as u32..end as u32
        });
        let shared = Arc::new((Ranges::new(blocks), Taken::new(jobs, workers)));
        let Stealing { amount, victim, .. } = self.stealing;
        let bodies = (0..workers).map(|worker| {
            let (job, shared) = (Arc::clone(&job), Arc::clone(&shared));
            move |panics: &Panics| {
                let (ranges, taken) = &*shared;
                let mut thief = Thief { worker, amount, victim, state: worker as u64 };
                let next = || ranges.pop(worker).or_else(|| thief.steal(ranges)).map(|index| index as usize);
                taken.work(worker, panics, next, &*job);
            }
        });
        team::run(&*self.config.spawner, bodies)
    }
}

/// A worker whose own range is empty.
struct Thief {
    worker: usize,
    amount: Amount,
    victim: Victim,
    /// Of the random numbers. Seeded with the worker's number, so that no clock and no luck from outside has a part in a run.
    state: u64,
}

impl Thief {
    /// A job from another worker; what comes with it is in this worker's range afterwards. `None` if no worker had one when asked.
    fn steal(&mut self, ranges: &Ranges) -> Option<u32> {
        let workers = ranges.workers();
        let thief = self.worker;
        let amount = match self.amount {
            Amount::One => |_| 1,
            Amount::Half => |left: u32| left.div_ceil(2),
        };
        let first = match self.victim {
            Victim::Neighbour => thief + 1,
            Victim::Random => (self.random() % workers as u64) as usize,
            // If it has become poor meanwhile, its neighbour will do.
            Victim::Richest => (0..workers).max_by_key(|&worker| ranges.left(worker))?,
        };
        let mut victims = (first..first + workers).map(|worker| worker % workers).filter(|&victim| victim != thief);
        victims.find_map(|victim| ranges.steal(thief, victim, amount))
    }

    /// `SplitMix64`: Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
    fn random(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.state ^ self.state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ mixed >> 31
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroUsize;

    /// Worker 0 has nothing, 1 one job, 2 none, 3 four jobs and 4 two.
    fn ranges() -> Ranges {
        Ranges::new([0..0, 0..1, 1..1, 1..5, 5..7].into_iter())
    }

    fn stolen(worker: usize, amount: Amount, victim: Victim, ranges: &Ranges) -> Option<u32> {
        Thief { worker, amount, victim, state: worker as u64 }.steal(ranges)
    }

    #[test]
    fn a_thief_takes_the_last_job_or_the_upper_half() {
        let from = ranges();
        assert_eq!(stolen(2, Amount::One, Victim::Neighbour, &from), Some(4));
        assert_eq!([2, 3].map(|worker| from.left(worker)), [0, 3]);
        // Half of three is two: 2 is run at once and 3 is the thief's.
        assert_eq!(stolen(2, Amount::Half, Victim::Neighbour, &from), Some(2));
        assert_eq!([2, 3].map(|worker| from.left(worker)), [1, 1]);
        assert_eq!((from.pop(2), from.pop(2), from.pop(3), from.pop(3)), (Some(3), None, Some(1), None));
    }

    #[test]
    fn the_victim_is_the_one_that_was_asked_for() {
        assert_eq!(stolen(0, Amount::One, Victim::Neighbour, &ranges()), Some(0));
        assert_eq!(stolen(0, Amount::One, Victim::Richest, &ranges()), Some(4));
        // Worker 3 first, then 4: a random start reaches both, and 1.
        let mut thief = Thief { worker: 0, amount: Amount::One, victim: Victim::Random, state: 0 };
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

    /// First value for seed 0, of the reference implementation by Vigna.
    #[test]
    fn the_generator_is_split_mix() {
        let mut thief = Thief { worker: 0, amount: Amount::One, victim: Victim::Random, state: 0 };
        assert_eq!(thief.random(), 0xe220_a839_7b1d_cdaf);
    }

    #[test]
    fn more_jobs_than_a_word_can_number_are_refused() {
        for name in ["steal-one", "steal-half"] {
            let entry = crate::strategy::find(name).unwrap();
            let mut strategy = (entry.new)(Config::new(NonZeroUsize::MIN)).unwrap();
            let error = strategy.run(MOST + 1, Arc::new(|_| panic!("nothing may run"))).unwrap_err();
            assert_eq!(
                error.to_string(),
                format!("strategy {name}: 4294967296 jobs are too many (allowed: 0 to 4294967295)")
            );
        }
    }
}
