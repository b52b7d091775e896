//! `mpiexec -n 4 pathmark render SCENE --ranks RULE`: one image by several processes.

use super::rounds::{self, Until};
use crate::cluster::{Cluster, RankRow, Tally};
use crate::console::Console;
use crate::error::Result;
use crate::lab::{Lab, RankRule};
use crate::measure::{Outcome, Record, Setup};
use clap::Args;
use serde::Serialize;
use std::env;
use std::path::PathBuf;

/// The options of a render by several processes.
#[derive(Args)]
pub(super) struct Ranks {
    /// Render with all processes that mpiexec started; they share the jobs by this rule: static-blocks, static-cyclic, dynamic:C, guided,
    /// trapezoid, factoring, mfac:S, weighted-factoring:W, awf-b, awf-c, adaptive-factoring, master-worker:C or working-master:C. Each process spreads its jobs over --threads by --strategy
    #[arg(long, value_name = "RULE", help_heading = "Processes",
          conflicts_with_all = ["adaptive", "shard"])]
    ranks: Option<String>,
    /// MPI library: auto, or the path of one [default: auto, or `PATHMARK_MPI`]
    #[arg(long, value_name = "auto|FILE", help_heading = "Processes", requires = "ranks")]
    mpi: Option<PathBuf>,
}

/// Statistics of the ranks, beside the outcome.
#[derive(Serialize)]
pub(super) struct Told {
    #[serde(skip)]
    ranks: usize,
    #[serde(skip)]
    rank_rule: String,
    #[serde(skip)]
    mpi: String,
    gather_s: f64,
    by_rank: Vec<RankRow>,
}

/// A record with the statistics of the ranks.
#[derive(Serialize)]
pub(super) struct WithRecord<'a> {
    #[serde(flatten)]
    record: &'a Record,
    #[serde(flatten)]
    told: &'a Told,
}

pub(super) fn with_record<'a>(told: &'a Told, record: &'a Record) -> WithRecord<'a> {
    WithRecord { record, told }
}

/// Enters ranks, rule and MPI library into a record.
pub(super) fn label(told: &Told, record: &mut Record) {
    record.ranks = u16::try_from(told.ranks).ok();
    record.rank_rule.clone_from(&told.rank_rule);
    record.mpi.clone_from(&told.mpi);
}

/// The library that the user names in the option or the environment; `None` if the program is to find one.
pub(super) fn library(option: Option<&PathBuf>) -> Option<PathBuf> {
    let named = option.cloned().or_else(|| env::var_os("PATHMARK_MPI").map(PathBuf::from));
    named.filter(|path| path.as_os_str() != "auto")
}

impl Ranks {
    /// The rule, if there is one.
    pub(super) fn rule(&self, lab: &Lab) -> Result<Option<RankRule>> {
        self.ranks.as_deref().map(|text| lab.rank_rule("ranks", text)).transpose()
    }

    /// Renders `spp` samples per pixel, or until another goal is reached; `None` on all ranks but the first.
    pub(super) fn render(
        &self,
        rule: &RankRule,
        setup: Setup,
        until: &Until,
        spp: u32,
        console: &Console,
    ) -> Result<Option<(Setup, Outcome, Told)>> {
        let library = library(self.mpi.as_ref());
        let cluster = Cluster::begin(library.as_deref())?;
        let done = if until.is_multi_round() {
            cluster.render_in_rounds(setup, rule, |setup, extend| rounds::render(until, setup, spp, console, extend))?
        } else {
            let done = cluster.render(&setup, rule)?;
            done.map(|(outcome, tally)| ((setup, outcome), tally))
        };
        Ok(done.map(|((setup, outcome), tally)| (setup, outcome, Told::new(rule, tally))))
    }
}

impl Told {
    fn new(rule: &RankRule, tally: Tally) -> Self {
        let Tally { ranks, gather_s, library } = tally;
        Self { ranks: ranks.len(), rank_rule: rule.to_string(), mpi: library, gather_s, by_rank: ranks }
    }
}

/// The statistics of each rank, in lines.
pub(super) fn told(told: &Told) -> String {
    let Told { ranks, rank_rule, mpi, gather_s, by_rank } = told;
    let head = format!("{ranks} ranks of {mpi} by {rank_rule}, gathered in {:.1} ms", 1e3 * gather_s);
    let lines = by_rank.iter().map(|RankRow { rank, jobs, requests, busy_s, waiting_s }| {
        format!("rank {rank}: {jobs} jobs in {requests} requests, {busy_s:.3} s busy, {waiting_s:.3} s waiting")
    });
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
}
