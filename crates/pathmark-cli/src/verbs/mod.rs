//! The verbs: one file for each, and files that several share.

mod axes;
mod bounces;
mod cases;
mod check;
mod claims;
mod compare;
mod completions;
mod convert;
mod diff;
mod explain;
mod guards;
mod letters;
mod list;
mod man;
mod merge;
mod message_costs;
mod new;
mod picture;
mod plan;
mod price;
mod profile;
mod rank;
mod ranks;
mod rays;
mod reference;
mod render;
mod replay;
mod report;
mod reproduce;
mod rounds;
mod run;
mod shard;
mod simulate;
mod strict;
mod trace;
mod whole;

use crate::console::Talk;
use crate::error::Result;
use crate::lab::Lab;
use clap::Subcommand;
use std::path::PathBuf;
use std::sync::Arc;

#[derive(Subcommand)]
pub(super) enum Verb {
    /// Run all committed experiments: CSV, figures and one report page.
    Reproduce(reproduce::Arguments),
    /// Render a scene.
    Render(render::Arguments),
    /// Merge the parts that `render --shard` or `run --shard` wrote on several machines.
    Merge(merge::Arguments),
    /// Run one experiment.
    Run(run::Arguments),
    /// Measure the error of an image against one reference, or against two to exclude their noise.
    Compare(compare::Arguments),
    /// Rank the schedules of an experiment: which can be told apart?
    Rank(rank::Arguments),
    /// Time MPI messages between the processes that mpiexec started.
    MessageCosts(message_costs::Arguments),
    /// Compare two measurements of an experiment: which cells got slower?
    Diff(diff::Arguments),
    /// Write a film or an image in another format.
    Convert(convert::Arguments),
    /// Predict the samples and seconds that an accuracy costs; --pay checks the prediction by rendering.
    Price(price::Arguments),
    /// Render the two half-references of a scene.
    Reference(reference::Arguments),
    /// Draw the figures and the page again from the records in a folder.
    Report(report::Arguments),
    /// Replay the jobs of a run on workers that this machine does not have.
    Simulate(simulate::Arguments),
    /// Show one run job by job.
    Trace(trace::Arguments),
    /// Show one sample's path, bounce by bounce.
    Replay(replay::Arguments),
    /// Show the light and path lengths of an image by number of bounces.
    Bounces(bounces::Arguments),
    /// Time the search for the nearest hit, along the rays of paths.
    Rays(rays::Arguments),
    /// Try the hard cases of numerics, sampling and statistics on this machine.
    Check(check::Arguments),
    /// Judge the claims of the four reports by the results in a folder.
    Claims(claims::Arguments),
    /// Write a commented starter file for an experiment or a scene.
    New(new::Arguments),
    /// Explain the warnings of rows: what each means, and what to do.
    Explain(explain::Arguments),
    /// List all names that options and files accept.
    List(list::Arguments),
    /// Print a completion script for a shell.
    Completions(completions::Arguments),
    /// Print a manual page.
    Man(man::Arguments),
    #[command(hide = true, about = crate::experiment::CELL_ABOUT)]
    Cell {
        /// The cell's description, for one of several processes
        file: Option<PathBuf>,
    },
}

impl Verb {
    /// Runs it.
    pub(super) fn run(self, lab: &Arc<Lab>, talk: &Talk) -> Result<()> {
        match self {
            Self::Reproduce(arguments) => reproduce::run(&arguments, lab, talk),
            Self::Render(arguments) => render::run(&arguments, lab, talk),
            Self::Merge(arguments) => merge::run(&arguments, lab, talk),
            Self::Run(arguments) => run::run(&arguments, lab, talk),
            Self::Compare(arguments) => compare::run(&arguments),
            Self::Rank(arguments) => rank::run(&arguments, lab, talk),
            Self::MessageCosts(arguments) => message_costs::run(&arguments),
            Self::Diff(arguments) => diff::run(&arguments, talk),
            Self::Convert(arguments) => convert::run(&arguments),
            Self::Price(arguments) => price::run(&arguments, lab, talk),
            Self::Reference(arguments) => reference::run(&arguments, lab, talk),
            Self::Claims(arguments) => claims::run(&arguments, lab),
            Self::Report(arguments) => report::run(&arguments, lab),
            Self::Simulate(arguments) => simulate::run(&arguments, lab, talk),
            Self::Trace(arguments) => trace::run(&arguments, talk),
            Self::Replay(arguments) => replay::run(&arguments, lab),
            Self::Bounces(arguments) => bounces::run(&arguments, lab, talk),
            Self::Rays(arguments) => rays::run(&arguments, lab, talk),
            Self::Check(arguments) => check::run(&arguments, lab, talk),
            Self::New(arguments) => new::run(&arguments),
            Self::Explain(arguments) => explain::run(&arguments),
            Self::List(arguments) => list::run(&arguments, lab),
            Self::Completions(arguments) => completions::run(&arguments),
            Self::Man(arguments) => man::run(&arguments),
            Self::Cell { file } => crate::experiment::child_main(lab, file.as_deref()),
        }
    }
}
