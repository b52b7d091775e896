//! One render by several processes, on one machine or on many, by MPI: `mpiexec -n 4 pathmark render cornell --ranks guided`.
//!
//! A rule assigns the jobs of the plan to ranks; within a rank a strategy spreads them over its threads. Any rule works
//! with any strategy. The film has the same bits as the film of one process: ranks send the sums of each piece, and
//! rank 0 puts the pieces in their places.
//!
//! In rounds, rank 0 alone knows the film and the goal. Before each round it sends the range of samples to the others;
//! they render their share, and forget it. A run that was ended can therefore continue with another number of ranks.

mod hand_out;
mod message_costs;
mod wire;

use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::film::ProgressiveFilm;
use crate::kernel::REVISION;
use crate::lab::RankRule;
use crate::machine::machine_id;
use crate::measure::{Extend, MergedShare, Outcome, Record, RoundTimes, Rounds, Setup};
use hand_out::HandOut;
pub use message_costs::{MessageCost, MessageCosts};
use pathmark_mpi::{MpiError, World};
use serde::Serialize;
use std::collections::HashMap;
use std::iter::once;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::slice::from_ref;
use std::{env, io};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RankRow {
    pub rank: usize,
    pub jobs: u64,
    pub requests: u64,
    /// Seconds that its workers spent on jobs, in total.
    pub busy_s: f64,
    /// Seconds that it waited for answers, and for the other ranks at the end.
    pub waiting_s: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tally {
    #[serde(rename = "by_rank")]
    pub ranks: Vec<RankRow>,
    /// Seconds to bring all pieces to rank 0, over all rounds.
    pub gather_s: f64,
    #[serde(skip)]
    pub library: String,
}

/// The processes that a launcher started together. [`Cluster::begin`] opens the library and starts MPI.
pub struct Cluster {
    world: World,
}

fn failed(error: MpiError) -> Error {
    match error {
        MpiError::NoLibrary { path, why } => {
            let problem = format!("cannot be opened as a library: {why}");
            InputError::new("mpi", path.display().to_string(), problem).allowed("an MPI library").into()
        }
        MpiError::NoSymbol { library, symbol } => {
            let problem = format!("is not an MPI library, or is too old: it lacks {symbol}");
            InputError::new("mpi", library, problem).allowed("an MPI library").into()
        }
        other => Error::system("using", "MPI", io::Error::other(other)),
    }
}

/// Sent instead of a range of samples: no round follows.
const NO_MORE: [u64; 2] = [0; 2];

impl Cluster {
    /// Opens the MPI library that the user names, here or in `PATHMARK_MPI`, or one that systems usually have.
    pub fn begin(library: Option<&Path>) -> Result<Self> {
        let named = library.map(PathBuf::from).or_else(|| env::var_os("PATHMARK_MPI").map(PathBuf::from));
        let named = named.filter(|path| path.as_os_str() != "auto");
        Ok(Self { world: World::begin(named.as_deref()).map_err(failed)? })
    }

    /// Whether this is rank 0, which has the image in the end and reports for all.
    pub fn is_first(&self) -> bool {
        self.world.rank() == 0
    }

    pub fn size(&self) -> usize {
        self.world.size()
    }

    /// Renders. Rank 0 gets the outcome that one process would give, with the workers of all ranks; the others get
    /// `None`. After an error of one rank the others cannot continue, and are ended.
    pub fn render(self, setup: &Setup, rule: &RankRule) -> Result<Option<(Outcome, Tally)>> {
        let ranks = self.agreed(setup, rule, "at once")?;
        let mut tally = Tally::new(&ranks.world);
        // If a process ends with an error and without finalizing MPI, the launcher ends the others.
        let gathered = ranks.round(setup, rule, from_ref(&(0..setup.settings().spp)), &mut tally)?;
        let outcome = gathered.map(|gathered| setup.assembled(gathered)).transpose()?;
        ranks.world.end().map_err(failed)?;
        Ok(outcome.map(|outcome| (outcome, tally)))
    }

    /// Returns `self` if all ranks can render this and have the same task. If tasks differ, every rank leaves MPI in order
    /// and gets the error. A rule that does not fit the ranks is refused before they talk, so MPI's launcher ends them.
    fn agreed(self, setup: &Setup, rule: &RankRule, way: &str) -> Result<Self> {
        rule.check(self.size())?;
        match self.check_same(setup, rule, way).and_then(|()| self.check_pins(setup)) {
            Ok(()) => Ok(self),
            Err(error) => {
                self.world.end().map_err(failed)?;
                Err(error)
            }
        }
    }

    fn check_same(&self, setup: &Setup, rule: &RankRule, way: &str) -> Result<()> {
        let settings = setup.settings();
        let text = format!(
            "{} {REVISION} {:?} {} {} {rule} {way} {} {}",
            env!("CARGO_PKG_VERSION"),
            setup.film_key(),
            settings.decomposition,
            settings.threads,
            settings.pin,
            setup.pins().len()
        );
        let mine = u64::from_str_radix(&digest::of_text(&text), 16).unwrap_or_default();
        let all = self.world.all_gather(&[mine]).map_err(failed)?;
        match all.iter().position(|other| *other != all[0]) {
            None => Ok(()),
            Some(rank) => {
                let problem = format!("rank {rank} would render something different from rank 0");
                let error = InputError::new("ranks", rule.to_string(), problem);
                Err(error.allowed("the same program, scene and options on all ranks").into())
            }
        }
    }

    /// Refuses pins that give one processor to two ranks. Each rank chooses among the processors that its launcher left
    /// it, and knows nothing of the others on its machine.
    fn check_pins(&self, setup: &Setup) -> Result<()> {
        if setup.pins().is_empty() {
            return Ok(());
        }
        let machine = u64::from_str_radix(&digest::of_text(&machine_id()), 16).unwrap_or_default();
        let row: Vec<u64> = once(machine).chain(setup.pins().iter().map(|cpu| *cpu as u64)).collect();
        let rows = self.world.all_gather(&row).map_err(failed)?;
        match shared_cpu(&rows.chunks_exact(row.len()).collect::<Vec<_>>()) {
            None => Ok(()),
            Some(([first, second], cpu)) => {
                let problem = format!("ranks {first} and {second} would both pin a worker to processor {cpu}");
                let error = InputError::new("pin", setup.settings().pin.to_string(), problem);
                Err(error.allowed("none, or a launcher that binds each rank to processors of its own").into())
            }
        }
    }

    /// Renders one round of these sections; rank 0 gets all jobs, the others `None`.
    fn round(
        &self,
        setup: &Setup,
        rule: &RankRule,
        sections: &[Range<u32>],
        tally: &mut Tally,
    ) -> Result<Option<MergedShare>> {
        let (world, threads) = (&self.world, setup.threads());
        let mut share = setup.share(sections)?;
        let mut hand_out = HandOut::new(rule, world, &mut share)?;
        world.barrier().map_err(failed)?;
        share.begin();
        let mut wait = hand_out.run(&mut share)?;
        let finished_s = share.elapsed_s();
        world.barrier().map_err(failed)?;
        let makespan_s = share.elapsed_s();
        wait.seconds += makespan_s - finished_s;
        hand_out.free()?;
        let (busy_s, brightest) = (share.busy_s(), share.brightest());
        let done = share.take_done();
        let row = [done.len() as u64, wait.requests, busy_s.to_bits(), wait.seconds.to_bits(), brightest.to_bits()];
        let rows = world.all_gather(&row).map_err(failed)?;
        // The maximum over the ranks that an exposure to the brightest pixel needs, on every rank.
        let brightest = rows.chunks_exact(row.len()).map(|row| f64::from_bits(row[4])).fold(0.0, f64::max);
        let first_worker = u32::try_from(world.rank() * threads).unwrap_or(u32::MAX);
        let before_s = share.elapsed_s();
        let words = world.gather(&wire::words(&done, first_worker)).map_err(failed)?;
        tally.gather_s += share.elapsed_s() - before_s;
        for (rank, row) in tally.ranks.iter_mut().zip(rows.chunks_exact(row.len())) {
            rank.jobs += row[0];
            rank.requests += row[1];
            rank.busy_s += f64::from_bits(row[2]);
            rank.waiting_s += f64::from_bits(row[3]);
        }
        if !self.is_first() {
            return Ok(None);
        }
        drop(done);
        let done =
            wire::jobs(&words, share.plan()).ok_or_else(|| Error::Check("a rank sent invalid jobs".to_string()))?;
        let gather_s = share.elapsed_s() - makespan_s;
        Ok(Some(MergedShare { done, workers: world.size() * threads, makespan_s, gather_s, brightest }))
    }

    /// Renders in rounds. On rank 0, calls `lead` with a function that extends its film; `lead` decides when to stop.
    /// The other ranks follow, and get `None`.
    pub fn render_in_rounds<T>(
        self,
        setup: Setup,
        rule: &RankRule,
        lead: impl FnOnce(Setup, Extend<'_>) -> Result<T>,
    ) -> Result<Option<(T, Tally)>> {
        let ranks = self.agreed(&setup, rule, "in rounds")?;
        let mut tally = Tally::new(&ranks.world);
        if !ranks.is_first() {
            ranks.follow(&setup, rule, &mut tally)?;
            ranks.world.end().map_err(failed)?;
            return Ok(None);
        }
        let mut is_broken = false;
        let led = lead(setup, &mut |rounds, spp| {
            is_broken = true;
            let times = ranks.lead_round(rounds, spp, rule, &mut tally)?;
            is_broken = false;
            Ok(times)
        });
        // After a failed round the others no longer listen; the launcher ends them.
        if !is_broken {
            ranks.tell(NO_MORE)?;
            ranks.world.end().map_err(failed)?;
        }
        led.map(|led| Some((led, tally)))
    }

    fn lead_round(&self, rounds: &mut Rounds, spp: u32, rule: &RankRule, tally: &mut Tally) -> Result<RoundTimes> {
        let from = rounds.spp();
        rounds.extend_by(spp, |setup, sections| {
            self.tell([u64::from(from), u64::from(spp)])?;
            let gathered = self.round(setup, rule, sections, tally)?;
            gathered.ok_or_else(|| Error::Check("rank 0 received no jobs from the other ranks".to_string()))
        })
    }

    fn follow(&self, setup: &Setup, rule: &RankRule, tally: &mut Tally) -> Result<()> {
        loop {
            let told = self.tell(NO_MORE)?;
            if told == NO_MORE {
                return Ok(());
            }
            let [from, to] = told.map(|samples| u32::try_from(samples).unwrap_or(u32::MAX));
            self.round(setup, rule, &ProgressiveFilm::missing_after(from, to), tally)?;
        }
    }

    /// Sends rank 0's `samples` to all ranks, and returns them.
    fn tell(&self, samples: [u64; 2]) -> Result<[u64; 2]> {
        let all = self.world.all_gather(&samples).map_err(failed)?;
        Ok(all.first_chunk().copied().unwrap_or(NO_MORE))
    }
}

/// Two ranks on one machine that have the same processor, and that processor. A row is the machine of a rank and its
/// processors.
fn shared_cpu(rows: &[&[u64]]) -> Option<([usize; 2], u64)> {
    let mut known = HashMap::new();
    let all = rows.iter().enumerate().flat_map(|(rank, row)| row[1..].iter().map(move |cpu| (rank, row[0], *cpu)));
    let mut all = all.filter_map(|(rank, machine, cpu)| Some(([known.insert((machine, cpu), rank)?, rank], cpu)));
    all.find(|([first, second], _)| first != second)
}

impl Tally {
    /// Enters ranks, rule and MPI library into a record.
    pub fn label(&self, rule: &RankRule, record: &mut Record) {
        record.ranks = u16::try_from(self.ranks.len()).ok();
        record.rank_rule = rule.to_string();
        record.mpi.clone_from(&self.library);
    }

    fn new(world: &World) -> Self {
        let row = |rank| RankRow { rank, jobs: 0, requests: 0, busy_s: 0.0, waiting_s: 0.0 };
        Self { ranks: (0..world.size()).map(row).collect(), gather_s: 0.0, library: world.version().to_string() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_of_one_machine_must_have_different_processors() {
        assert_eq!(shared_cpu(&[&[7, 0, 1], &[7, 2, 3]]), None);
        assert_eq!(shared_cpu(&[&[7, 0, 1], &[8, 0, 1]]), None);
        assert_eq!(shared_cpu(&[&[7, 0, 1], &[8, 0, 1], &[7, 3, 1]]), Some(([0, 2], 1)));
    }
}
