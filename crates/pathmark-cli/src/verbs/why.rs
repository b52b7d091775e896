//! `pathmark why DIR`: why is a schedule not as many times as fast as it has workers?

use super::run::note_doubts;
use crate::console::Console;
use crate::console::output::{print, print_json};
use crate::error::{InputError, Result};
use crate::lab::Lab;
use crate::report::Results;
use crate::report::why::{Explained, explain};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;

/// `pathmark why out/thread-scaling`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folder of an experiment: `out/thread-scaling`
    folder: PathBuf,
    /// Print the parts of all schedules as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let refused = |problem: &str, allowed: &str| {
        InputError::new("folder", arguments.folder.display().to_string(), problem).allowed(allowed)
    };
    if arguments.folder.exists() && !arguments.folder.is_dir() {
        return Err(refused("is not a folder", "as in out/thread-scaling").into());
    }
    let results = Results::open(lab, &arguments.folder)?;
    let found = explain(&results)?;
    if found.is_empty() {
        let problem =
            "contains no schedule of several workers with a serial run of the same image in the same repetition";
        return Err(refused(problem, "the folder of an experiment with the strategy serial and others").into());
    }
    if arguments.json {
        print_json(&json!({ "schedules": found, "doubted_rows": results.doubts().count() }))?;
    } else {
        print(&found.iter().map(in_words).collect::<Vec<_>>().join("\n\n"))?;
    }
    note_doubts(&results.doubts(), console);
    Ok(())
}

/// The parts of a schedule's time, a line each, and the sentence about them.
fn in_words(found: &Explained) -> String {
    let percents: Vec<(&str, String)> = found.percents().collect();
    let width = percents.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines = percents.iter().map(|(name, share)| format!("  {name:width$}  {share:>7}"));
    let lines = std::iter::once(found.name.clone()).chain(lines).chain([found.sentence.clone()]);
    lines.collect::<Vec<_>>().join("\n")
}
