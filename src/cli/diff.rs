//! `pathmark diff OLD NEW`: which cells got slower?

use super::output::{counted, number, print, print_json};
use super::progress::Talk;
use super::run::talk_of;
use crate::error::{Error, Result};
use crate::experiment::{Across, CellDiff, Change, CountDiff, Diff, Progress as _, count_diff, diff, parse_share};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::PathBuf;

/// `pathmark diff before/thread-scaling after/thread-scaling --fail-above 3%`
#[derive(Args)]
pub(super) struct Arguments {
    /// The old measurement: the folder of an experiment, or a file of rows
    old: PathBuf,
    /// The new measurement, likewise
    new: PathBuf,
    /// Exit with code 1 if a cell is certainly slower by more than this; smaller changes count as the same
    #[arg(long, value_name = "SHARE", default_value = "2%", allow_hyphen_values = true)]
    fail_above: String,
    /// Whether undecided cells make the command fail
    #[arg(long, value_enum, default_value_t = Undecided::Pass)]
    undecided: Undecided,
    /// Compare counts instead of times: jobs, paths, rays, tests of boxes and primitives, and instructions after
    /// `run --count-instructions`. Counts have no noise
    #[arg(long)]
    counts: bool,
    #[command(flatten)]
    across: AcrossOptions,
    /// Print the comparison as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct AcrossOptions {
    /// Compare even if the measurements are from two machines
    #[arg(long)]
    across_machines: bool,
    /// Compare even if the images of the two builds differ in some bits
    #[arg(long)]
    across_revisions: bool,
}

/// How undecided cells count.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Undecided {
    /// They do not make the command fail
    Pass,
    /// They make it fail
    Fail,
}

pub(super) fn run(arguments: &Arguments, talk: &Talk) -> Result<()> {
    let limit = parse_share("fail-above", &arguments.fail_above)?;
    if arguments.counts {
        return counts(arguments, limit);
    }
    let AcrossOptions { across_machines: machines, across_revisions: revisions } = arguments.across;
    let across = Across { machines, revisions };
    let found = diff(&arguments.old, &arguments.new, limit, across)?;
    let count = |change: Change| found.cells.iter().filter(|cell| cell.change == change).count();
    let (slower, undecided) = (count(Change::Slower), count(Change::Undecided));
    if arguments.json {
        print_json(&object(&found, limit))?;
    } else {
        print(&table(&found))?;
        let counts = [Change::Slower, Change::Faster, Change::Same, Change::Undecided]
            .map(|change| format!("{} {}", count(change), change.name()));
        let percent = 100.0 * limit;
        print(&format!("{}; the limit between same and slower is {percent} %", counts.join(", ")))?;
    }
    remark(&found, talk);
    if slower > 0 {
        let problem = format!("{} got slower by more than {} %", counted(slower, "cell"), 100.0 * limit);
        return Err(Error::Check(problem));
    }
    if undecided > 0 && arguments.undecided == Undecided::Fail {
        let problem = format!("{} undecided: more repetitions are needed", counted(undecided, "cell"));
        return Err(Error::Check(problem));
    }
    Ok(())
}

/// Compares counts instead of times.
fn counts(arguments: &Arguments, limit: f64) -> Result<()> {
    let (changed, compared) = count_diff(&arguments.old, &arguments.new)?;
    if arguments.json {
        print_json(&json!({ "limit": limit, "compared": compared, "changed": changed }))?;
    } else {
        for count in &changed {
            let CountDiff { cell, column, old, new } = count;
            print(&format!("{:>8.4} {column:<16} {old:>12} {new:>12}  {cell}", count.ratio()))?;
        }
        print(&format!("{} of {} changed", changed.len(), counted(compared, "count")))?;
    }
    let above = changed.iter().filter(|count| count.ratio() > 1.0 + limit).count();
    if above > 0 {
        let problem = format!("{} grew by more than {} %", counted(above, "count"), 100.0 * limit);
        return Err(Error::Check(problem));
    }
    Ok(())
}

/// Prints warnings and notes about the comparison.
fn remark(found: &Diff, talk: &Talk) {
    if !found.paired {
        talk.note(
            "warning: not measured in turns, so a change of the machine looks like a change of the program (run --against)",
        );
    }
    if found.stopped_by_times {
        talk.note(
            "warning: the repetitions of a cell depended on its times (run --until), so the intervals are too narrow",
        );
    }
    let [old, new] = found.unmatched;
    if old + new > 0 {
        talk.note(&format!(
            "{} of the old and {} of the new have no counterpart",
            counted(old, "cell"),
            counted(new, "cell")
        ));
    }
    talk_of(&found.doubts, talk);
}

fn table(found: &Diff) -> String {
    let head = format!("{:>8} {:>16} {:<9}  {:>9}  {:>9}  cell", "new/old", "interval", "change", "old", "new");
    let line = |cell: &CellDiff| {
        let interval = cell.interval.map_or_else(|| "-".to_string(), |i| format!("{:.3} to {:.3}", i.low, i.high));
        let CellDiff { ratio, old_s, new_s, change, cell, .. } = cell;
        let change = change.name();
        format!("{ratio:>8.3} {interval:>16} {change:<9}  {:>6.1} ms  {:>6.1} ms  {cell}", 1e3 * old_s, 1e3 * new_s)
    };
    std::iter::once(head).chain(found.cells.iter().map(line)).collect::<Vec<_>>().join("\n")
}

fn object(found: &Diff, limit: f64) -> Value {
    let cells = found.cells.iter().map(|cell| {
        json!({
            "cell": cell.cell, "change": cell.change, "ratio": number(cell.ratio), "interval": cell.interval,
            "old_s": number(cell.old_s), "new_s": number(cell.new_s), "repetitions": cell.repetitions,
        })
    });
    json!({
        "limit": limit, "paired": found.paired, "sequential": found.sequential, "doubted_rows": found.doubts.count(), "unmatched": found.unmatched,
        "cells": cells.collect::<Vec<_>>(),
    })
}
