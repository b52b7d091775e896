//! Static blocks: each worker gets one contiguous run of jobs, fixed before the first one starts.
//!
//! `pathmark render cornell --strategy static-blocks --threads 4`
//!
//! The block distribution of data-parallel languages, and OpenMP's `schedule(static)`. Sizes differ by one job at most: the
//! remainder goes to the first workers, one each.
//!
//! Cost: one thread's start for each worker and nothing for a job. Neighbouring jobs stay together, which is good for caches and
//! bad for balance: where costs vary smoothly, one worker gets all the dear ones.

use std::ops::Range;
use std::sync::Arc;

use super::team::{self, Panics};
use super::{Config, Entry, Job, Strategy, StrategyError, Workers};

pub(super) const ENTRY: Entry = Entry {
    name: "static-blocks",
    about: "one contiguous block of jobs for each worker, fixed beforehand",
    workers: Workers::Threads,
    new,
};

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    Ok(Box::new(StaticBlocks(config.without_parameter(ENTRY.name)?)))
}

struct StaticBlocks(Config);

impl Strategy for StaticBlocks {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let workers = self.0.threads.get().min(jobs);
        let bodies = (0..workers).map(|worker| {
            let job = Arc::clone(&job);
            let mine = block(worker, workers, jobs);
            move |panics: &Panics| {
                for index in mine {
                    if panics.stop_asked() {
                        break;
                    }
                    job(index);
                }
            }
        });
        team::run(&*self.0.spawner, bodies)
    }
}

/// The jobs of `worker`. Block w starts where block w - 1 ends, the first at 0 and the last ends at `jobs`: each index is in one.
fn block(worker: usize, workers: usize, jobs: usize) -> Range<usize> {
    // Not worker * jobs / workers, whose product overflows.
    let (size, remainder) = (jobs / workers, jobs % workers);
    let start = |worker: usize| worker * size + worker.min(remainder);
    start(worker)..start(worker + 1)
}

#[cfg(test)]
mod tests {
    use super::block;

    #[test]
    fn the_remainder_goes_to_the_first_workers() {
        let blocks: Vec<_> = (0..4).map(|worker| block(worker, 4, 10)).collect();
        assert_eq!(blocks, [0..3, 3..6, 6..8, 8..10]);
    }

    #[test]
    fn blocks_join_up_and_differ_by_one_at_most() {
        for jobs in [1, 7, 768, (1 << 32) + 1, usize::MAX] {
            for workers in [1, 2, 3, 8, 1000] {
                let blocks: Vec<_> = (0..workers).map(|worker| block(worker, workers, jobs)).collect();
                assert_eq!((blocks[0].start, blocks[workers - 1].end), (0, jobs));
                assert!(blocks.windows(2).all(|pair| pair[0].end == pair[1].start), "{jobs} jobs, {workers} workers");
                let sizes = blocks.iter().map(ExactSizeIterator::len);
                assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1, "{jobs} jobs, {workers} workers");
            }
        }
    }
}
