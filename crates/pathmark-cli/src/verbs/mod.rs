//! The verbs: one file for each, and files that several share.

mod artifact;
mod bursts;
mod claims;
mod contract;
mod diff;
mod doctor;
mod grade;
mod image;
mod inspect;
mod list;
mod machine;
mod merge;
mod new;
mod overall_progress;
mod plan_of_claims;
mod prelude;
mod price;
mod rank;
mod ranks;
mod renamed;
mod render;
mod replicate;
mod report;
mod reproduce;
mod rounds;
mod run;
mod selftest;
mod setting_options;
mod shard;
mod shell;
mod simulate;
mod strict;
mod why;

use prelude::*;

pub(super) use renamed::with_new_names;

#[derive(Subcommand)]
pub(super) enum Verb {
    /// Run all experiments at one size: rows, figures and one page.
    Reproduce(reproduce::Arguments),
    /// Render a scene.
    Render(render::Arguments),
    /// Merge the parts that `render --shard` or `run --shard` wrote on several machines.
    Merge(merge::Arguments),
    /// Run one experiment: rows, figures and a page.
    Run(run::Arguments),
    /// Measure the error of an image, write it in another format, or render a reference.
    #[command(subcommand)]
    Image(image::Image),
    /// Rank the schedules of an experiment: which can be told apart?
    Rank(rank::Arguments),
    /// Explain why each schedule is not as many times as fast as it has workers, and what to try.
    Why(why::Arguments),
    /// Compare two measurements of an experiment: which cells got slower?
    Diff(diff::Arguments),
    /// Predict the samples and seconds that an accuracy costs; --verify checks the prediction by rendering.
    Price(price::Arguments),
    /// Test whether a strategy keeps the contract: each job runs once, panics reach the caller, no thread is left over.
    Contract(contract::Arguments),
    /// Grade programs with strategies of their own: contract, image, and speedup beside the built-in strategies.
    Grade(grade::Arguments),
    /// Draw the figures and the page again from the rows in a folder, or in the folders of a class.
    Report(report::Arguments),
    /// Replay the jobs of a run on workers that this machine does not have.
    Simulate(simulate::Arguments),
    /// Look into a path, the light by bounces, the search for hits, the jobs of a run or MPI messages.
    #[command(subcommand)]
    Inspect(inspect::Inspect),
    /// Test the hard cases of numerics, sampling and statistics on this machine.
    Selftest(selftest::Arguments),
    /// Compare pools on short parallel regions with gaps: wake latency, and processor time of idle workers.
    Bursts(bursts::Arguments),
    /// Judge the claims of the four reports, or of a ledger of your own, by the results in a folder.
    Claims(claims::Arguments),
    /// Measure somebody's rows again on this machine: which of their ratios, orders and images come out here, too?
    Replicate(replicate::Arguments),
    /// Pack rows, ledger, verdicts and instructions for an artifact committee, or check such an archive.
    Artifact(artifact::Arguments),
    /// Write a commented starter file for an experiment, a scene or a ledger of claims.
    New(new::Arguments),
    /// Examine this machine before a sweep: what disturbs measurements, and which differences can be seen?
    Doctor(doctor::Arguments),
    /// Show processors, cores, sockets, memory nodes and caches, and which of them may be used.
    Machine(machine::Arguments),
    /// List all names that options and files accept, or explain one, such as a warning.
    List(list::Arguments),
    /// Print completion scripts and manual pages.
    #[command(subcommand)]
    Shell(shell::Shell),
    #[command(hide = true, about = crate::experiment::CELL_ABOUT)]
    Cell {
        /// The cell's description, for one of several processes
        file: Option<PathBuf>,
    },
}

impl Verb {
    pub(super) fn run(self, lab: &Arc<Lab>, console: &Console) -> Result<()> {
        match self {
            Self::Reproduce(arguments) => reproduce::run(&arguments, lab, console),
            Self::Render(arguments) => render::run(&arguments, lab, console),
            Self::Merge(arguments) => merge::run(&arguments, lab, console),
            Self::Run(arguments) => run::run(&arguments, lab, console),
            Self::Rank(arguments) => rank::run(&arguments, lab, console),
            Self::Why(arguments) => why::run(&arguments, lab, console),
            Self::Diff(arguments) => diff::run(&arguments, console),
            Self::Price(arguments) => price::run(&arguments, lab, console),
            Self::Bursts(arguments) => bursts::run(&arguments, lab, console),
            Self::Claims(arguments) => claims::run(&arguments, lab),
            Self::Replicate(arguments) => replicate::run(&arguments, lab, console),
            Self::Artifact(arguments) => artifact::run(&arguments, lab),
            Self::Contract(arguments) => contract::run(&arguments, lab),
            Self::Grade(arguments) => grade::run(&arguments, lab, console),
            Self::Report(arguments) => report::run(&arguments, lab, console),
            Self::Simulate(arguments) => simulate::run(&arguments, lab, console),
            Self::Image(what) => what.run(lab, console),
            Self::Inspect(what) => what.run(lab, console),
            Self::Selftest(arguments) => selftest::run(&arguments, lab, console),
            Self::Shell(what) => what.run(),
            Self::New(arguments) => new::run(&arguments),
            Self::Doctor(arguments) => doctor::run(&arguments, lab, console),
            Self::Machine(arguments) => machine::run(&arguments),
            Self::List(arguments) => list::run(&arguments, lab),
            Self::Cell { file } => crate::experiment::child_main(lab, file.as_deref()),
        }
    }
}
