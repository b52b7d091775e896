//! Self-scheduling: a free worker takes the next chunk from the shared place.

use super::crew::Crew;
use crate::strategy::{ChunkRule, Handout};

pub(super) fn run(crew: &mut Crew<'_>, rule: ChunkRule) {
    let (jobs, workers) = (crew.jobs(), crew.workers());
    let mut handout = Handout { jobs, workers, start: 0, chunks: 0, parameter: rule.parameter };
    while let Some((worker, now_s)) = crew.next_free() {
        match rule.next(&mut handout) {
            Some(chunk) => {
                let got_s = crew.through_shared_place(worker, 1, now_s);
                let free_s = crew.work(worker, chunk, got_s);
                crew.ask_again(worker, free_s);
            }
            None => _ = crew.work(worker, [], now_s),
        }
    }
}
