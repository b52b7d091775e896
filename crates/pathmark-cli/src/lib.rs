//! The command line: one file for each verb. Results go to standard output or files, messages to standard error.
//!
//! Exit codes: 0 done, 1 a check failed, 2 the user's input is wrong, 3 the system failed.

mod console;
mod verbs;

use crate::error::{Error, InputError};
use crate::lab::Lab;
use clap::error::ErrorKind;
use clap::{CommandFactory, FromArgMatches, Parser};
pub use console::Allocator;
use console::{Console, watch_memory};
use pathmark_check as check;
use pathmark_harness::{
    analysis, atomic_file, cases_file, cluster, csv_file, error, experiment, files, film, film_file, guard_prices,
    image_io, input, kernel, lab, lock, material, math, measure, metric, sampling, scene, shell, simd, simulate,
    strategy,
};
use pathmark_report::{self as report, plot};
use std::ffi::OsString;
use std::io;
use std::process::ExitCode;
use std::sync::Arc;
use verbs::{Verb, with_new_names};

/// The most common uses, in five lines.
const EXAMPLES: &str = "\
Examples:
  pathmark render cornell --spp 64 -o cornell.png            render a scene
  pathmark run thread-scaling                                compare schedules: rows, figures and a page
  pathmark price cornell --rmse 0.1,0.05                     predict what an accuracy costs
  pathmark reproduce                                         run all experiments
  pathmark simulate rows.csv --workers 1..64                 forecast a traced run on more cores

Measure: reproduce, run, rank, why, diff, price, bursts, grade
Tell: report, claims, replicate, artifact    Render: render, merge, image
Look inside: inspect, simulate    Ask: doctor, machine, list, new, contract, selftest, shell

Exit codes: 0 done, 1 a check failed, 2 the input is wrong, 3 the system refused";

/// A laboratory for scheduling unequal work on many cores, and for what accuracy costs in time.
#[derive(Parser)]
#[command(name = "pathmark", version, max_term_width = 110, after_help = EXAMPLES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
    /// Print only errors on standard error.
    #[arg(long, global = true)]
    quiet: bool,
}

/// Runs the program with these tables and the process's arguments.
pub fn main(lab: Lab) -> ExitCode {
    watch_memory();
    let cli = match read_arguments(&lab) {
        Ok(cli) => cli,
        Err(told) if told.kind() == ErrorKind::InvalidUtf8 => {
            let error = no_text(&mut described());
            Console::new(false).error(&error);
            return ExitCode::from(error.exit_code());
        }
        Err(told) => return tell(&told),
    };
    let console = Console::new(cli.quiet);
    match lab.check().and_then(|()| cli.verb.run(&Arc::new(lab), &console)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            console.error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}

/// The error for an argument that must be text and is not; clap's message does not say which. Paths of other files may
/// be any bytes, but rows and traces keep the name of a scene or an experiment as text. So an argument is the culprit if
/// the command line is refused even with text in place of all others that are not text.
fn no_text(command: &mut clap::Command) -> Error {
    let arguments = with_new_names(std::env::args_os());
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
    let mut command = with_negative_numbers(Cli::command()).display_name(name).version(&*version.leak());
    let matches = command.try_get_matches_from_mut(with_new_names(std::env::args_os()))?;
    Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
}

/// A negative number after an option is its value, so that the option can name it and its range. clap would take it for
/// an option.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let option = |arg: clap::Arg| {
        let takes_value = arg.get_long().is_some() && arg.get_action().takes_values();
        if takes_value { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(option).mut_subcommands(with_negative_numbers)
}

/// Prints clap's message instead of running: an error, or the requested help or version.
fn tell(told: &clap::Error) -> ExitCode {
    match told.print() {
        Err(e) if !told.use_stderr() && e.kind() != io::ErrorKind::BrokenPipe => {
            let error = Error::system("writing", "standard output", e);
            Console::new(false).error(&error);
            ExitCode::from(error.exit_code())
        }
        _ => u8::try_from(told.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from),
    }
}

/// The command line as data.
fn described() -> clap::Command {
    Cli::command()
}

/// The command as the user gave it, without the program's folder.
fn command_line() -> String {
    shell::command(std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()))
}
