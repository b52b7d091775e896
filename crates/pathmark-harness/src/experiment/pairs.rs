//! Runs in adjacent pairs: cells that are compared take turns, each in a process that stays for all pairs.
//!
//! The processes of a group of cells run together, one cell at a time. Two runs that follow each other share the machine's
//! speed, so drift and most disturbances leave their ratio (L. Bulej et al., "Duet Benchmarking", ICPE 2020). Two cells go
//! first in alternating order (A B, B A, ...); a larger group runs in a random order in which compared cells are near, and then
//! in its reverse. A process has one memory layout, so the pairs are repeated in new processes: [`crate::analysis::adjacent_pairs`]. Short runs are
//! repeated within a turn ([`crate::measure::batch_runs`]).

use super::CellJob;
use super::cell_process::ended;
use super::comparisons::Comparison;
use super::conversation::{Answer, Conversation};
use super::shuffle::shuffled;
use super::time_limit::timed_out;
use crate::kernel::DEVICE_NAME;
use crate::machine::{PinPolicy, fastest_cpus};
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

/// Random orders of a round, of which the one counts in which compared cells are nearest.
const ORDERS: u32 = 32;

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

    /// Whether it runs on one processor, wherever the system wants it.
    fn may_be_placed(&self) -> bool {
        let settings = &self.job.settings;
        settings.is_serial() && settings.pin == PinPolicy::None && settings.spec.kernel != DEVICE_NAME
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

/// How the processes of a group take turns.
pub(super) struct Turns<'a> {
    /// The random numbers of orders follow from it.
    pub(super) name: &'a str,
    /// Pairs of a process.
    pub(super) pairs: u32,
    /// The places in the group of cells that are compared.
    pub(super) compared: Vec<[usize; 2]>,
}

impl<'a> Turns<'a> {
    /// Turns in which compared cells are near; the members of the group are places in the list of cells.
    pub(super) fn of(name: &'a str, pairs: u32, group: &[usize], comparisons: &[Comparison]) -> Self {
        let place = |cell: usize| group.iter().position(|member| *member == cell);
        let compared = comparisons.iter().filter_map(|pair| Some([place(pair.what)?, place(pair.with)?])).collect();
        Self { name, pairs, compared }
    }

    /// The order of a pair: every second one is the reverse of the one before. Processes begin with either in turn, because
    /// one with long runs has only one pair.
    fn order(&self, cells: usize, process: u32, pair: u32) -> Vec<usize> {
        let (twice, is_second) = (process / 2, process % 2 == 1);
        let round = twice.wrapping_mul(self.pairs.div_ceil(2)).wrapping_add(pair / 2);
        let orders =
            (0..ORDERS).map(|number| shuffled(cells, self.name, round.wrapping_mul(ORDERS).wrapping_add(number)));
        let mut order = orders.min_by_key(|order| self.distance(order)).unwrap_or_default();
        if (pair % 2 == 1) != is_second {
            order.reverse();
        }
        order
    }

    /// The sum of the distances of compared cells. Two runs differ the more, the more time lies between them.
    fn distance(&self, order: &[usize]) -> usize {
        let mut places = vec![0; order.len()];
        for (place, cell) in order.iter().enumerate() {
            places[*cell] = place;
        }
        self.compared.iter().map(|[one, other]| places[*one].abs_diff(places[*other])).sum()
    }
}

/// The processor of a group of serial cells. Two processors may differ in speed for as long as a process lives, because a host
/// shares one of them; runs that take turns share theirs. Other processes use other processors, of the fastest kind. `None`
/// for a group with another build, which might not follow.
fn shared_cpu(group: &[Contestant], process: u32) -> Option<usize> {
    let are_alike = group.windows(2).all(|two| two[0].program == two[1].program);
    let cpus = if are_alike && group.iter().all(Contestant::may_be_placed) { fastest_cpus() } else { Vec::new() };
    // Two processes of one processor, because these begin with either order.
    cpus.get(process as usize / 2 % cpus.len().max(1)).copied()
}

/// Runs the pairs of a group; returns the rows with the places of their cells in the group, in the order in which they ran.
pub(super) fn run_pairs(group: &mut [Contestant], turns: &Turns<'_>, process: u32) -> Vec<(usize, Record)> {
    let cpu = shared_cpu(group, process);
    for member in group.iter_mut() {
        member.job.cpu = cpu;
    }
    let mut rows: Vec<(usize, Record)> = Vec::new();
    let (mut pair, mut wanted) = (0, turns.pairs);
    while pair < wanted {
        for (place, at) in turns.order(group.len(), process, pair).into_iter().enumerate() {
            if let Some(row) = group[at].run() {
                rows.push((at, Record { pair: Some(pair), place: Some(place as u32), ..row }));
            }
        }
        if pair == 0 {
            // The first pair is the pilot of the others.
            let longest_s = rows.iter().filter_map(|(_, row)| row.makespan_s).fold(0.0, f64::max);
            wanted = affordable(turns.pairs, longest_s);
        }
        pair += 1;
    }
    rows
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
    use crate::measure::{SERIAL, Settings};

    #[test]
    fn long_runs_have_fewer_pairs() {
        assert_eq!([0.0, 0.05, 0.1, 0.4, 0.5, 60.0].map(|length| affordable(16, length)), [16, 16, 8, 2, 1, 1]);
        assert_eq!(affordable(1, 0.01), 2);
    }

    fn with(strategy: &str, pin: PinPolicy) -> Settings {
        Settings { strategy: strategy.to_string(), pin, ..Settings::default() }
    }

    fn turns(pairs: u32, compared: &[[usize; 2]]) -> Turns<'static> {
        Turns { name: "x", pairs, compared: compared.to_vec() }
    }

    /// With one pair for each process, the orders alternate between processes.
    #[test]
    fn processes_of_one_pair_alternate() {
        for process in (0..8).step_by(2) {
            let [first, mut second] = [process, process + 1].map(|process| turns(6, &[]).order(9, process, 0));
            second.reverse();
            assert_eq!(first, second, "{process}");
        }
    }

    /// Also with an odd number of pairs, which is rounded up.
    #[test]
    fn every_second_order_is_the_reverse_of_the_one_before() {
        for (process, pairs) in [(0, 4), (1, 5), (3, 1), (7, 16)] {
            for pair in (0..affordable(pairs, 0.0)).step_by(2) {
                let [first, mut second] = [pair, pair + 1].map(|pair| turns(pairs, &[[0, 1]]).order(9, process, pair));
                second.reverse();
                assert_eq!(first, second, "{process} {pairs} {pair}");
            }
        }
    }

    /// Serial cells share a processor, which changes with every second process. Workers that may move, a pin that somebody asked
    /// for, and another build leave the placement to the system.
    #[test]
    fn serial_cells_of_a_group_share_a_processor() {
        let member = |settings: Settings, program: &str| {
            Contestant::new(CellJob { settings, ..CellJob::default() }, Ok(program.into()), None)
        };
        let beside = |settings: Settings, program: &str| {
            [member(with(SERIAL, PinPolicy::None), "own"), member(settings, program)]
        };
        let (serial, cpus) = (beside(with(SERIAL, PinPolicy::None), "own"), fastest_cpus());
        for process in 0..9 {
            let expected = cpus.get(process as usize / 2 % cpus.len().max(1)).copied();
            assert_eq!(shared_cpu(&serial, process), expected);
        }
        for other in [
            beside(with("rayon", PinPolicy::None), "own"),
            beside(with(SERIAL, PinPolicy::Compact), "own"),
            beside(with(SERIAL, PinPolicy::None), "other"),
        ] {
            assert_eq!(shared_cpu(&other, 0), None);
        }
    }

    /// The one with which all others are compared runs in the middle, and each of a chain beside the next one. In a random
    /// order, two of five cells are two places apart in the mean.
    #[test]
    fn compared_cells_run_near_each_other() {
        let mean = |compared: &[[usize; 2]]| {
            let turns = turns(8, compared);
            let rounds = (0..16).flat_map(|process| [0, 2, 4, 6].map(|pair| turns.order(5, process, pair)));
            rounds.map(|order| turns.distance(&order)).sum::<usize>() as f64 / (64 * compared.len()) as f64
        };
        let (star, chain) = (mean(&[[1, 0], [2, 0], [3, 0], [4, 0]]), mean(&[[0, 1], [1, 2], [2, 3], [3, 4]]));
        assert!((1.5..1.55).contains(&star) && (1.0..1.35).contains(&chain), "{star} {chain}");
        let all: Vec<[usize; 2]> = (0..5).flat_map(|one| (0..one).map(move |other| [one, other])).collect();
        assert!((mean(&all) - 2.0).abs() < 1e-12);
    }
}
