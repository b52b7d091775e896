//! Dynamic: a free worker takes the next C jobs.
//!
//! `pathmark render cornell --strategy dynamic:8 --threads 4`; without a number C is 1, which is `shared-counter` with a list.
//!
//! Chunk self-scheduling: Kruskal and Weiss, "Allocating independent subtasks on parallel processors", IEEE TSE 11(10), 1985. OpenMP
//! calls it `schedule(dynamic, C)`.
//!
//! Cost: one thread start for each worker, one atomic addition for each chunk. Larger chunks need fewer additions but
//! leave a longer tail: up to C jobs remain with one worker when the others have no more jobs to take.

use crate::{ChunkRule, Discipline, Entry, Handout, Parameter};

pub(super) const ENTRY: Entry = Entry {
    parameter: Some(Parameter { allowed: "a number of jobs from 1", read }),
    ..Entry::chunks("dynamic", "a free worker takes the next C jobs (dynamic:C; C is 1 by default)", size)
};

/// Returns C for every chunk.
pub(super) fn size(handout: &Handout) -> usize {
    handout.parameter
}

fn read(value: &str) -> Option<Discipline> {
    let parameter = value.parse().ok().filter(|&chunk: &usize| chunk > 0)?;
    Some(Discipline::Chunks(ChunkRule { size, parameter }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_of_the_size_that_was_asked_for() {
        let sizes = |text, jobs| match read(text) {
            Some(Discipline::Chunks(rule)) => rule.chunks(jobs, 3).map(|chunk| chunk.len()).collect::<Vec<_>>(),
            other => panic!("{other:?}"),
        };
        assert_eq!(sizes("4", 10), [4, 4, 2]);
        assert_eq!(sizes("100", 10), [10]);
        assert!(["0", "-1", "x", "", "1.5"].iter().all(|text| read(text).is_none()));
    }
}
