//! `mpiexec -n 4 pathmark render SCENE --ranks RULE`: one image by several processes.

use super::prelude::*;
use super::rounds::{self, Until};
use crate::cluster::{Cluster, RankRow, Tally};
use crate::lab::RankRule;
use crate::measure::{Extend, Outcome};

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

/// A record with the statistics of the ranks.
#[derive(Serialize)]
pub(super) struct WithRecord<'a> {
    #[serde(flatten)]
    pub(super) record: &'a Record,
    #[serde(flatten)]
    pub(super) tally: &'a Tally,
}

impl Ranks {
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
    ) -> Result<Option<((Setup, Outcome), Tally)>> {
        let cluster = Cluster::begin(self.mpi.as_deref())?;
        if until.is_multi_round() {
            let lead = |setup, extend: Extend<'_>| rounds::render(until, setup, spp, console, extend);
            return cluster.render_in_rounds(setup, rule, lead);
        }
        Ok(cluster.render(&setup, rule)?.map(|(outcome, tally)| ((setup, outcome), tally)))
    }
}

/// The statistics of each rank, in lines.
pub(super) fn told(rule: &RankRule, Tally { ranks: by_rank, gather_s, library }: &Tally) -> String {
    let head = format!("{} ranks of {library} by {rule}, gathered in {:.1} ms", by_rank.len(), 1e3 * gather_s);
    let lines = by_rank.iter().map(|RankRow { rank, jobs, requests, busy_s, waiting_s }| {
        format!("rank {rank}: {jobs} jobs in {requests} requests, {busy_s:.3} s busy, {waiting_s:.3} s waiting")
    });
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
}
