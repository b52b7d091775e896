//! Guided self-scheduling: a free worker takes 1/p of the jobs left.
//!
//! `pathmark render cornell --strategy guided --threads 4`
//!
//! Polychronopoulos and Kuck, "Guided self-scheduling: a practical scheduling scheme for parallel supercomputers", IEEE Trans. Computers
//! C-36(12), 1987. OpenMP calls it `schedule(guided)`.
//!
//! Cost: one thread start for each worker, one atomic addition for each of about p ln(n/p) chunks. The first chunks are
//! as large as static ones: if the expensive jobs come first, one worker is still busy with them when all others are
//! done.

use crate::{Entry, Handout};

pub(super) const ENTRY: Entry = Entry::chunks("guided", "a free worker takes 1/p of the jobs left (GSS)", size);

/// Returns 1/p of the jobs left, rounded up.
pub(super) fn size(handout: &Handout) -> usize {
    (handout.jobs - handout.start).div_ceil(handout.workers)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ChunkRule;

    /// The example of the paper: 100 iterations on 5 processors.
    #[test]
    fn sizes_are_those_of_the_paper() {
        let rule = ChunkRule { size, parameter: 1 };
        let sizes: Vec<usize> = rule.chunks(100, 5).map(|chunk| chunk.len()).collect();
        assert_eq!(sizes, [20, 16, 13, 11, 8, 7, 5, 4, 4, 3, 2, 2, 1, 1, 1, 1, 1]);
    }
}
