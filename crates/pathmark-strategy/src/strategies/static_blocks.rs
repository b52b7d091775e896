//! Static blocks: each worker gets one contiguous block of jobs, fixed before the first job starts.
//!
//! `pathmark render cornell --strategy static-blocks --threads 4`
//!
//! The block distribution of data-parallel languages, and OpenMP's `schedule(static)`. Sizes differ by at most one job:
//! the first workers get the remainder, one job each.
//!
//! Cost: one thread start for each worker and nothing for a job. Neighbouring jobs stay together, which is good for
//! caches and bad for balance: if costs vary smoothly, one worker gets all the expensive jobs.

use std::iter::StepBy;
use std::ops::Range;

use crate::Entry;

pub(super) const ENTRY: Entry =
    Entry::dealt("static-blocks", "one contiguous block of jobs for each worker, fixed beforehand", deal);

/// Returns the jobs of `worker`. Block w starts where block w - 1 ends. The first block starts at 0 and the last ends
/// at `jobs`, so each index is in one block.
pub fn block(worker: usize, workers: usize, jobs: usize) -> Range<usize> {
    // Not worker * jobs / workers, because the product can overflow.
    let (size, remainder) = (jobs / workers, jobs % workers);
    let start = |worker: usize| worker * size + worker.min(remainder);
    start(worker)..start(worker + 1)
}

/// Returns the block of `worker` as a deal, whose type also allows jobs that lie apart.
pub(super) fn deal(worker: usize, workers: usize, jobs: usize) -> StepBy<Range<usize>> {
    block(worker, workers, jobs).step_by(1)
}

#[cfg(test)]
mod tests {
    use super::block;

    #[test]
    fn the_remainder_goes_to_the_first_workers() {
        let blocks: Vec<Vec<usize>> = (0..4).map(|worker| block(worker, 4, 10).collect()).collect();
        assert_eq!(blocks, [vec![0, 1, 2], vec![3, 4, 5], vec![6, 7], vec![8, 9]]);
    }

    #[test]
    fn blocks_join_up_and_differ_by_one_at_most() {
        for jobs in [1, 7, 768, (1 << 32) + 1, usize::MAX] {
            for workers in [1, 2, 3, 8, 1000] {
                let mut end = 0;
                for worker in 0..workers {
                    let mut block = block(worker, workers, jobs);
                    let size = block.len();
                    assert!([jobs / workers, jobs.div_ceil(workers)].contains(&size), "{jobs} jobs, {workers} workers");
                    if size > 0 {
                        assert_eq!(block.next(), Some(end), "{jobs} jobs, {workers} workers");
                        end += size;
                    }
                }
                assert_eq!(end, jobs);
            }
        }
    }
}
