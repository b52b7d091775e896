//! Dynamic: whoever is free takes the next C jobs.
//!
//! `pathmark render cornell --strategy dynamic:8 --threads 4`; without a number C is 1, which is `shared-counter` with a list.
//!
//! Chunk self-scheduling: Kruskal and Weiss, "Allocating independent subtasks on parallel processors", IEEE TSE 11(10), 1985. OpenMP
//! calls it `schedule(dynamic, C)`.
//!
//! Cost: one thread's start for each worker, one atomic addition for each chunk. Larger chunks mean fewer additions and a longer tail: up
//! to C jobs are left to one worker when the others have nothing more to take.

use super::self_scheduling;
use super::{ChunkRule, Config, Discipline, Entry, Handout, Sharing, Strategy, StrategyError, Threads, Workers};

pub(super) const ENTRY: Entry = Entry {
    name: "dynamic",
    about: "whoever is free takes the next C jobs (dynamic:C; 1 if no number is given)",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

/// C jobs each time.
pub(super) fn size(handout: &Handout) -> usize {
    handout.parameter
}

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    let refusal = |value: &str| StrategyError::Parameter {
        strategy: ENTRY.name,
        value: value.to_owned(),
        allowed: "a number of jobs from 1".to_owned(),
    };
    let text = parameter.unwrap_or("1");
    let parameter = text.parse().ok().filter(|&chunk: &usize| chunk > 0).ok_or_else(|| refusal(text))?;
    Ok(Discipline::Chunks(ChunkRule { size, parameter }))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    self_scheduling::new(config, &ENTRY)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_of_the_size_that_was_asked_for() {
        let sizes = |text, jobs| match discipline(Some(text)) {
            Ok(Discipline::Chunks(rule)) => rule.chunks(jobs, 3).map(|chunk| chunk.len()).collect::<Vec<_>>(),
            other => panic!("{other:?}"),
        };
        assert_eq!(sizes("4", 10), [4, 4, 2]);
        assert_eq!(sizes("100", 10), [10]);
        assert!(["0", "-1", "x", "", "1.5"].iter().all(|text| discipline(Some(text)).is_err()));
    }
}
