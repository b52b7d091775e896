//! `pathmark doctor`: the machine's condition, and the smallest difference that can be seen on it.

use crate::console::Console;
use crate::console::output::{print, print_json};
use crate::error::{InputError, Result};
use crate::experiment::{DOCTOR, Examination, Progress};
use crate::lab::Lab;
use crate::measure::equal_pairs;
use clap::Args;
use std::path::Path;

/// `pathmark doctor`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Seconds of the examination
    #[arg(long, value_name = "N", default_value_t = 20.0, allow_hyphen_values = true)]
    seconds: f64,
    /// Print an object with facts and noise
    #[arg(long)]
    json: bool,
    /// Time pairs of equal runs for so many seconds: one process of an examination
    #[arg(long, value_name = "SECONDS", hide = true)]
    pairs_for: Option<f64>,
}

/// Most seconds of an examination.
const LONGEST_S: f64 = 3600.0;
/// Seconds of the examination in `reproduce`.
const SHORT_S: f64 = 3.0;

pub(super) fn run(arguments: &Arguments, lab: &Lab, console: &Console) -> Result<()> {
    let seconds = arguments.pairs_for.unwrap_or(arguments.seconds);
    if !(seconds > 0.0 && seconds <= LONGEST_S) {
        let error = InputError::new("seconds", seconds.to_string(), "is out of range");
        return Err(error.allowed(format!("above 0, up to {LONGEST_S}")).into());
    }
    if arguments.pairs_for.is_some() {
        return print_json(&equal_pairs(lab, seconds)?);
    }
    console.note(&format!("timing pairs of equal runs for {seconds} s"));
    let found = examined(seconds)?;
    if arguments.json { print_json(&found) } else { print(&found.lines().join("\n")) }
}

fn examined(seconds: f64) -> Result<Examination> {
    Examination::now(seconds, |command, seconds| {
        command.args(["doctor", "--pairs-for"]).arg(seconds.to_string());
    })
}

/// Writes a short examination into a folder of results, unless it has one.
pub(super) fn examine_into(out: &Path, console: &Console) -> Result<()> {
    let path = out.join(DOCTOR);
    if path.is_file() {
        return Ok(());
    }
    let found = examined(SHORT_S)?;
    found.noise.iter().for_each(|noise| console.note(&noise.finding()));
    found.write(&path)
}
