//! Trapezoid self-scheduling: chunks shrink by the same number of jobs each time.
//!
//! `pathmark render cornell --strategy trapezoid --threads 4`
//!
//! Tzen and Ni, "Trapezoid self-scheduling: a practical scheduling scheme for parallel compilers", IEEE TPDS 4(1), 1993, with the sizes
//! they recommend: the first chunk has n/(2p) jobs, the last one job.
//!
//! Cost: one thread's start for each worker, one atomic addition for each of about 4p chunks. The first chunks are half the size of
//! guided self-scheduling's, so dear jobs at the beginning hurt less.

use super::self_scheduling::{self, rule};
use super::{Config, Discipline, Entry, Handout, Sharing, Strategy, StrategyError, Threads, Workers, unless_set};

pub(super) const ENTRY: Entry = Entry {
    name: "trapezoid",
    about: "whoever is free takes a chunk that is a fixed step smaller than the last one (TSS)",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

/// Chunk number k has first - k step jobs, where the step is such that about ceil(2n / (first + last)) chunks are needed.
pub(super) fn size(handout: &Handout) -> usize {
    let first = (handout.jobs / (2 * handout.workers)).max(1);
    let chunks = (2 * handout.jobs).div_ceil(first + 1);
    let step = if chunks > 1 { (first - 1) / (chunks - 1) } else { 0 };
    first.saturating_sub(handout.chunks.saturating_mul(step)).max(1)
}

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    unless_set(ENTRY.name, parameter, rule(size))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    self_scheduling::new(config, &ENTRY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strategy::ChunkRule;

    /// 1000 jobs on 4 workers: first = 125, 16 chunks, step = floor(124 / 15) = 8.
    #[test]
    fn sizes_fall_in_a_straight_line() {
        let rule = ChunkRule { size, parameter: 1 };
        let sizes: Vec<usize> = rule.chunks(1000, 4).map(|chunk| chunk.len()).collect();
        assert_eq!(sizes, [125, 117, 109, 101, 93, 85, 77, 69, 61, 53, 45, 37, 28]);
    }
}
