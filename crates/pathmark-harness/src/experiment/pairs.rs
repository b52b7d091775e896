//! Runs in adjacent pairs: cells that are compared take turns, each in a process that stays for all pairs.
//!
//! The processes of a group of cells run together, one cell at a time. Two runs that follow each other share the machine's
//! speed, so drift and most disturbances leave their ratio (L. Bulej et al., "Duet Benchmarking", ICPE 2020). Two cells go
//! first in alternating order (A B, B A, ...); a larger group runs in a random order, and then in its reverse. A process has
//! one memory layout, so the pairs are repeated in new processes: [`crate::analysis::adjacent_pairs`]. Short runs are
//! repeated within a turn ([`crate::measure::batch_runs`]).

use super::CellJob;
use super::cell_process::ended;
use super::conversation::{Answer, Conversation};
use super::shuffle::shuffled;
use super::time_limit::timed_out;
use crate::measure::Record;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

/// Pairs of a process, if the definition sets none.
pub(super) const USUAL_PAIRS: u32 = 16;
/// Seconds of a run up to which a process has all of its pairs. Longer runs have fewer.
const SHORT_S: f64 = 0.05;
/// Seconds of a run from which a process has one pair, and counts its first run: starting it costs little in comparison.
pub(super) const LONG_S: f64 = 0.5;

/// A cell's process in a group.
pub(super) struct Contestant {
    job: CellJob,
    program: Result<PathBuf, String>,
    limit: Option<Duration>,
    talk: Option<Conversation>,
    has_failed: bool,
}

impl Contestant {
    pub(super) fn new(job: CellJob, program: Result<PathBuf, String>, limit: Option<Duration>) -> Self {
        Self { job: CellJob { stays: true, ..job }, program, limit, talk: None, has_failed: false }
    }

    /// Runs the cell once. After a failure it does not run again.
    fn run(&mut self) -> Option<Record> {
        if self.has_failed {
            return None;
        }
        let rows = self.answer().and_then(|answer| self.job.rows(answer.as_bytes()));
        let mut rows = rows.unwrap_or_else(|error| self.job.failed(&error));
        let row = rows.pop()?;
        self.has_failed = !row.error.is_empty() || row.is_left_out();
        Some(row)
    }

    fn answer(&mut self) -> Result<String, String> {
        let running = |e: std::io::Error| format!("running the cell's process: {e}");
        if let Some(talk) = &mut self.talk {
            match talk.ask("again", self.limit).map_err(running)? {
                Answer::Line(answer) => return Ok(answer),
                Answer::Late => return Err(timed_out(self.limit)),
                // An older build does not stay: each of its runs has a new process.
                Answer::Ended(status, _) if status.success() => {}
                Answer::Ended(status, said) => return Err(ended(status, &said)),
            }
        }
        let mut command = Command::new(self.program.clone()?);
        command.arg("cell");
        let text = serde_json::to_string(&self.job).map_err(|e| format!("describing the cell: {e}"))?;
        let talk = self.talk.insert(Conversation::begin(command).map_err(running)?);
        match talk.ask(&text, self.limit).map_err(running)? {
            Answer::Line(answer) => Ok(answer),
            Answer::Late => Err(timed_out(self.limit)),
            Answer::Ended(status, said) => Err(ended(status, &said)),
        }
    }
}

/// Runs the pairs of a group; returns the rows with the places of their cells in the group, in the order in which they ran.
pub(super) fn run_pairs(group: &mut [Contestant], pairs: u32, name: &str, process: u32) -> Vec<(usize, Record)> {
    let mut rows: Vec<(usize, Record)> = Vec::new();
    let (mut pair, mut wanted) = (0, pairs);
    while pair < wanted {
        for (place, at) in order(group.len(), name, [process, pairs, pair]).into_iter().enumerate() {
            if let Some(row) = group[at].run() {
                rows.push((at, Record { pair: Some(pair), place: Some(place as u32), ..row }));
            }
        }
        if pair == 0 {
            // The first pair is the pilot of the others.
            let longest_s = rows.iter().filter_map(|(_, row)| row.makespan_s).fold(0.0, f64::max);
            wanted = affordable(pairs, longest_s);
        }
        pair += 1;
    }
    rows
}

/// The order of a pair: every second one is the reverse of the one before. Processes begin with either in turn, because
/// one with long runs has only one pair.
fn order(cells: usize, name: &str, [process, pairs, pair]: [u32; 3]) -> Vec<usize> {
    let (twice, is_second) = (process / 2, process % 2 == 1);
    let mut order = shuffled(cells, name, twice.wrapping_mul(pairs.div_ceil(2)).wrapping_add(pair / 2));
    if (pair % 2 == 1) != is_second {
        order.reverse();
    }
    order
}

/// The number of pairs for runs of that length: one if they are long, and otherwise even, so that each order occurs as often
/// as its reverse.
pub(super) fn affordable(pairs: u32, longest_s: f64) -> u32 {
    if longest_s >= LONG_S {
        return 1;
    }
    let share = (SHORT_S / longest_s.max(f64::MIN_POSITIVE)).min(1.0);
    let pairs = ((f64::from(pairs) * share) as u32).max(2);
    pairs.next_multiple_of(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_runs_have_fewer_pairs() {
        assert_eq!([0.0, 0.05, 0.1, 0.4, 0.5, 60.0].map(|length| affordable(16, length)), [16, 16, 8, 2, 1, 1]);
        assert_eq!(affordable(1, 0.01), 2);
    }

    /// With one pair for each process, the orders alternate between processes.
    #[test]
    fn processes_of_one_pair_alternate() {
        for process in (0..8).step_by(2) {
            let [first, mut second] = [process, process + 1].map(|process| order(9, "x", [process, 6, 0]));
            second.reverse();
            assert_eq!(first, second, "{process}");
        }
    }

    /// Also with an odd number of pairs, which is rounded up.
    #[test]
    fn every_second_order_is_the_reverse_of_the_one_before() {
        for (process, pairs) in [(0, 4), (1, 5), (3, 1), (7, 16)] {
            for pair in (0..affordable(pairs, 0.0)).step_by(2) {
                let [first, mut second] = [pair, pair + 1].map(|pair| order(9, "x", [process, pairs, pair]));
                second.reverse();
                assert_eq!(first, second, "{process} {pairs} {pair}");
            }
        }
    }
}
