//! Self-scheduling by measured speed: a free worker reports how long its last jobs took, which decides the size of its
//! next chunk.

use super::crew::Crew;
use crate::strategy::{LearnedRule, Ledger};

pub(super) fn run(crew: &mut Crew<'_>, rule: LearnedRule) {
    let mut ledger = Ledger::new(crew.jobs(), crew.workers(), rule.weights);
    let mut last = vec![0..0; crew.workers()];
    while let Some((worker, now_s)) = crew.next_free() {
        ledger.note(worker, crew.seen(last[worker].clone()));
        match rule.next(&mut ledger, worker) {
            Some(chunk) => {
                let got_s = crew.through_shared_place(worker, 1, now_s);
                let free_s = crew.work(worker, chunk.clone(), got_s);
                last[worker] = chunk;
                crew.ask_again(worker, free_s);
            }
            None => _ = crew.work(worker, [], now_s),
        }
    }
}
