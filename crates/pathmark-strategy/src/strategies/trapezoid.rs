//! Trapezoid self-scheduling: chunks shrink by the same number of jobs each time.
//!
//! `pathmark render cornell --strategy trapezoid --threads 4`
//!
//! Tzen and Ni, "Trapezoid self-scheduling: a practical scheduling scheme for parallel compilers", IEEE TPDS 4(1), 1993, with the sizes
//! they recommend: the first chunk has n/(2p) jobs, the last one job.
//!
//! Cost: one thread start for each worker, one atomic addition for each of about 4p chunks. The first chunks are half
//! as large as in guided self-scheduling, so expensive jobs at the beginning hurt less.

use crate::{Entry, Handout};

pub(super) const ENTRY: Entry = Entry::chunks(
    "trapezoid",
    "a free worker takes a chunk that is smaller than the last one by a fixed step (TSS)",
    size,
);

/// Returns the size of chunk k: first - k step jobs. The step is such that about ceil(2n / (first + last)) chunks are
/// needed.
pub(super) fn size(handout: &Handout) -> usize {
    let first = (handout.jobs / (2 * handout.workers)).max(1);
    let chunks = (2 * handout.jobs).div_ceil(first + 1);
    let step = if chunks > 1 { (first - 1) / (chunks - 1) } else { 0 };
    first.saturating_sub(handout.chunks.saturating_mul(step)).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ChunkRule;

    /// 1000 jobs on 4 workers: first = 125, 16 chunks, step = floor(124 / 15) = 8.
    #[test]
    fn sizes_fall_in_a_straight_line() {
        let rule = ChunkRule { size, parameter: 1 };
        let sizes: Vec<usize> = rule.chunks(1000, 4).map(|chunk| chunk.len()).collect();
        assert_eq!(sizes, [125, 117, 109, 101, 93, 85, 77, 69, 61, 53, 45, 37, 28]);
    }
}
