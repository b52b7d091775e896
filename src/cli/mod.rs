//! The command line: one file for each verb. Results go to standard output or files, messages to standard error.
//!
//! Exit codes: 0 done, 1 a check failed, 2 the user's input is wrong, 3 the system failed.

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
mod out_of_memory;
mod output;
mod picture;
mod plan;
mod price;
mod profile;
mod progress;
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

use crate::error::{Error, InputError, Result};
use crate::lab::Lab;
use crate::shell;
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
pub use out_of_memory::Allocator;
use progress::Talk;
use std::ffi::OsString;
use std::io;
use std::process::ExitCode;
use std::sync::Arc;

/// The most common uses, in five lines.
const EXAMPLES: &str = "\
Examples:
  pathmark render cornell --spp 64 -o cornell.png            render a scene
  pathmark run thread-scaling                                compare schedules: rows, figures and a page
  pathmark price cornell --rmse 0.1,0.05                     predict what an accuracy costs
  pathmark reproduce                                         run all experiments
  pathmark simulate rows.csv --workers 1..64                 forecast a traced run on more cores

Measure: reproduce, run, rank, diff, price, report, claims, message-costs   Render: render, merge, reference, compare, convert
Look inside: trace, simulate, replay, bounces, rays    Ask: list, explain, new, check, man, completions";

/// A laboratory for scheduling unequal work on many cores, and for what accuracy costs in time.
#[derive(Parser)]
#[command(name = "pathmark", version, about, max_term_width = 110, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Print only errors on standard error.
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Subcommand)]
enum Verb {
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
    Cell,
}

impl Lab {
    /// Runs the program with these tables and the process's arguments.
    pub fn main(self) -> ExitCode {
        out_of_memory::watch();
        let cli = match read_arguments(&self) {
            Ok(cli) => cli,
            Err(told) if told.kind() == ErrorKind::InvalidUtf8 => {
                let error = no_text(&mut described());
                Talk::new(false).error(&error);
                return ExitCode::from(error.exit_code());
            }
            Err(told) => return tell(&told),
        };
        let talk = Talk::new(cli.quiet);
        match self.check().and_then(|()| run_verb(cli.verb, &Arc::new(self), &talk)) {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                talk.error(&error);
                ExitCode::from(error.exit_code())
            }
        }
    }
}

/// The error for an argument that must be text and is not; clap's message does not say which. Paths of other files may
/// be any bytes, but rows and traces keep the name of a scene or an experiment as text. So an argument is the culprit if
/// the command line is refused even with text in place of all others that are not text.
fn no_text(command: &mut clap::Command) -> Error {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let is_text = |argument: &OsString| argument.to_str().is_some();
    let is_refused = |culprit: &usize| {
        let kept =
            |(place, argument)| if place == *culprit || is_text(argument) { argument.clone() } else { "x".into() };
        let told = command.try_get_matches_from_mut(arguments.iter().enumerate().map(kept));
        told.is_err_and(|told| told.kind() == ErrorKind::InvalidUtf8)
    };
    let mut bad = (1..arguments.len()).filter(|place| !is_text(&arguments[*place]));
    let culprit = bad.find(is_refused).map(|place| arguments[place].to_string_lossy().into_owned());
    let value = culprit.unwrap_or_else(|| "one of several".to_string());
    InputError::new("argument", value, "is not UTF-8 text").allowed("a name of UTF-8 text").into()
}

/// Reads the process's arguments. `--version` tells the program's own name and version.
fn read_arguments(lab: &Lab) -> std::result::Result<Cli, clap::Error> {
    let [name, version] = lab.program();
    // clap keeps a version for as long as the program runs.
    let mut command = Cli::command().display_name(name).version(&*version.leak());
    let matches = command.try_get_matches_from_mut(std::env::args_os())?;
    Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// Prints clap's message instead of running: an error, or the requested help or version.
fn tell(told: &clap::Error) -> ExitCode {
    match told.print() {
        Err(e) if !told.use_stderr() && e.kind() != io::ErrorKind::BrokenPipe => {
            let error = Error::system("writing", "standard output", e);
            Talk::new(false).error(&error);
            ExitCode::from(error.exit_code())
        }
        _ => u8::try_from(told.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from),
    }
}

/// The command line as data.
fn described() -> clap::Command {
    Cli::command()
}

fn run_verb(verb: Verb, lab: &Arc<Lab>, talk: &Talk) -> Result<()> {
    match verb {
        Verb::Reproduce(arguments) => reproduce::run(&arguments, lab, talk),
        Verb::Render(arguments) => render::run(&arguments, lab, talk),
        Verb::Merge(arguments) => merge::run(&arguments, lab, talk),
        Verb::Run(arguments) => run::run(&arguments, lab, talk),
        Verb::Compare(arguments) => compare::run(&arguments),
        Verb::Rank(arguments) => rank::run(&arguments, lab, talk),
        Verb::MessageCosts(arguments) => message_costs::run(&arguments),
        Verb::Diff(arguments) => diff::run(&arguments, talk),
        Verb::Convert(arguments) => convert::run(&arguments),
        Verb::Price(arguments) => price::run(&arguments, lab, talk),
        Verb::Reference(arguments) => reference::run(&arguments, lab, talk),
        Verb::Claims(arguments) => claims::run(&arguments, lab),
        Verb::Report(arguments) => report::run(&arguments, lab),
        Verb::Simulate(arguments) => simulate::run(&arguments, lab, talk),
        Verb::Trace(arguments) => trace::run(&arguments, talk),
        Verb::Replay(arguments) => replay::run(&arguments, lab),
        Verb::Bounces(arguments) => bounces::run(&arguments, lab, talk),
        Verb::Rays(arguments) => rays::run(&arguments, lab, talk),
        Verb::Check(arguments) => check::run(&arguments, lab, talk),
        Verb::New(arguments) => new::run(&arguments),
        Verb::Explain(arguments) => explain::run(&arguments),
        Verb::List(arguments) => list::run(&arguments, lab),
        Verb::Completions(arguments) => completions::run(&arguments),
        Verb::Man(arguments) => man::run(&arguments),
        Verb::Cell => crate::experiment::child_main(lab),
    }
}

/// The command as the user gave it, without the program's folder.
fn command_line() -> String {
    shell::command(std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()))
}
