//! `pathmark diff OLD NEW`: which cells got slower, and which are lost?

use super::prelude::*;
use super::run::note_doubts;
use crate::console::markdown;
use crate::error::printable;
use crate::experiment::{
    Across, CellDiff, Change, Compared, CountDiff, Diff, FailedCell, Lost, count_diff, diff, parse_share,
};

/// `pathmark diff before/thread-scaling after/thread-scaling --fail-above 3%`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The old measurement: the folder of an experiment, a folder of experiments, or a file of rows
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
    /// Print the comparison as tables in Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
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

/// The largest number of lost cells that an error names; the table names all.
const MOST_TOLD: usize = 20;

pub(super) fn run(arguments: &Arguments, console: &Console) -> Result<()> {
    let limit = parse_share("fail-above", &arguments.fail_above)?;
    if arguments.counts {
        return counts(arguments, limit, console);
    }
    let AcrossOptions { across_machines: machines, across_revisions: revisions } = arguments.across;
    let across = Across { machines, revisions };
    let found = diff(&arguments.old, &arguments.new, limit, across)?;
    let all = || found.experiments.iter().flat_map(|(_, diff)| &diff.cells);
    let count = |change: Change| all().filter(|cell| cell.change == change).count();
    if arguments.json {
        print_json(&object(&found, limit)?)?;
    } else {
        let shown = if arguments.markdown { in_markdown } else { table };
        print(&by_experiment(&found, shown).join("\n"))?;
        let counts = [Change::Slower, Change::Faster, Change::Same, Change::Undecided]
            .map(|change| format!("{} {}", count(change), change.name()));
        let percent = 100.0 * limit;
        print(&format!("{}; the limit between same and slower is {percent} %", counts.join(", ")))?;
    }
    for (name, diff) in &found.experiments {
        remark(name, diff, console);
    }
    let mut problems = losses(&found, |diff| &diff.lost, console);
    let (slower, undecided) = (count(Change::Slower), count(Change::Undecided));
    if slower > 0 {
        problems.push(format!("{} got slower by more than {} %", counted(slower, "cell"), 100.0 * limit));
    }
    if undecided > 0 && arguments.undecided == Undecided::Fail {
        problems.push(format!("{} undecided: more repetitions are needed", counted(undecided, "cell")));
    }
    failed(&problems)
}

fn counts(arguments: &Arguments, limit: f64, console: &Console) -> Result<()> {
    let found = count_diff(&arguments.old, &arguments.new)?;
    let all = || found.experiments.iter().flat_map(|(_, diffs)| &diffs.changed);
    if arguments.json {
        print_json(&object(&found, limit)?)?;
    } else {
        let shown = if arguments.markdown { counts_in_markdown } else { counts_in_lines };
        let lines = by_experiment(&found, |diffs| shown(&diffs.changed));
        let compared = found.experiments.iter().map(|(_, diffs)| diffs.compared).sum();
        let end = format!("{} of {} changed", all().count(), counted(compared, "count"));
        print(&lines.into_iter().chain([end]).collect::<Vec<_>>().join("\n"))?;
    }
    let mut problems = losses(&found, |diffs| &diffs.lost, console);
    let above = all().filter(|count| count.ratio() > 1.0 + limit).count();
    if above > 0 {
        problems.push(format!("{} grew by more than {} %", counted(above, "count"), 100.0 * limit));
    }
    failed(&problems)
}

fn counts_in_lines(changed: &[CountDiff]) -> Vec<String> {
    let line =
        |[ratio, column, old, new, cell]: [String; 5]| format!("{ratio:>8} {column:<16} {old:>12} {new:>12}  {cell}");
    changed.iter().map(count_cells).map(line).collect()
}

fn counts_in_markdown(changed: &[CountDiff]) -> Vec<String> {
    let table = markdown::table(["new/old", "count", "old", "new", "cell"], changed.iter().map(count_cells));
    vec![format!("\n{table}\n")]
}

/// Ratio, column, both counts and the cell of a count that changed.
fn count_cells(count: &CountDiff) -> [String; 5] {
    let CountDiff { cell, column, old, new } = count;
    let cell = printable(cell).into_owned();
    [format!("{:.4}", count.ratio()), (*column).to_string(), old.to_string(), new.to_string(), cell]
}

fn failed(problems: &[String]) -> Result<()> {
    if problems.is_empty() { Ok(()) } else { Err(Error::Check(problems.join("; "))) }
}

/// The lines of all experiments, below their names if there are several.
fn by_experiment<T>(found: &Compared<T>, lines: impl Fn(&T) -> Vec<String>) -> Vec<String> {
    let headed = found.experiments.iter().flat_map(|(name, of)| {
        let head = Some(printable(name).into_owned()).filter(|name| !name.is_empty());
        head.into_iter().chain(lines(of))
    });
    headed.collect()
}

/// Notes the experiments that only the new measurement has, and returns in words what only the old one has.
fn losses<T>(found: &Compared<T>, lost: impl Fn(&T) -> &Lost, console: &Console) -> Vec<String> {
    let [only_old, only_new] = &found.alone;
    for name in only_new {
        console.note(&format!("experiment {}: only the new measurement has it", printable(name)));
    }
    let place = |name: &str, cell: &str| {
        let of = if name.is_empty() { String::new() } else { format!("{} ", printable(name)) };
        format!("{of}{}", printable(cell))
    };
    let all = || found.experiments.iter().map(|(name, of)| (name, lost(of)));
    let missing: Vec<String> =
        all().flat_map(|(name, lost)| lost.missing.iter().map(|cell| place(name, cell))).collect();
    let with_error = all().flat_map(|(name, lost)| {
        lost.failed.iter().map(|FailedCell { cell, failed, rows, error }| {
            format!("{} ({failed} of {}: {})", place(name, cell), counted(*rows, "row"), printable(error))
        })
    });
    let told = |names: Vec<String>, thing: &str, lack: &str| {
        let rest = names.len().saturating_sub(MOST_TOLD);
        let more = (rest > 0).then(|| format!("{rest} more"));
        let named: Vec<String> = names.iter().take(MOST_TOLD).cloned().chain(more).collect();
        (!names.is_empty())
            .then(|| format!("{} {lack} in the new measurement: {}", counted(names.len(), thing), named.join(", ")))
    };
    let only_old = only_old.iter().map(|name| printable(name).into_owned()).collect();
    [
        told(only_old, "experiment", "missing"),
        told(missing, "cell", "missing"),
        told(with_error.collect(), "cell", "failed"),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Prints warnings and notes about the comparison of an experiment.
fn remark(name: &str, found: &Diff, console: &Console) {
    let of = if name.is_empty() { String::new() } else { format!(" ({})", printable(name)) };
    if !found.paired {
        console.note(&format!(
            "warning: not measured in turns with each other, so a change of the machine looks like a change of the program (run --baseline){of}",
        ));
    }
    if found.stopped_by_times {
        console.note(&format!(
            "warning: the repetitions of a cell depended on its times (run --until), so the intervals are too narrow{of}",
        ));
    }
    let [old, new] = found.unmatched;
    if old + new > 0 {
        console.note(&format!(
            "{} of the old and {} of the new have no counterpart{of}",
            counted(old, "cell"),
            counted(new, "cell")
        ));
    }
    note_doubts(&found.doubts, console);
}

const HEADS: [&str; 6] = ["new/old", "interval", "change", "old", "new", "cell"];

fn table(found: &Diff) -> Vec<String> {
    let line = |[ratio, interval, change, old, new, cell]: [String; 6]| {
        format!("{ratio:>8} {interval:>16} {change:<9}  {old:>9}  {new:>9}  {cell}")
    };
    std::iter::once(HEADS.map(str::to_string)).chain(cells(found)).map(line).collect()
}

/// A table between blank lines: Markdown needs them.
fn in_markdown(found: &Diff) -> Vec<String> {
    vec![format!("\n{}\n", markdown::table(HEADS, cells(found)))]
}

/// Ratio, interval, change, both times and the name of each cell, and of those that are lost.
fn cells(found: &Diff) -> Vec<[String; 6]> {
    let of = |cell: &CellDiff| {
        let interval = cell.interval.map_or_else(|| "-".to_string(), |i| format!("{:.3} to {:.3}", i.low, i.high));
        let [old, new] = [cell.old_s, cell.new_s].map(|seconds| format!("{:.1} ms", 1e3 * seconds));
        let name = printable(&cell.cell).into_owned();
        [format!("{:.3}", cell.ratio), interval, cell.change.name().to_string(), old, new, name]
    };
    let lost = |cell: &str, how: &str| ["-", "-", how, "-", "-", &printable(cell)].map(str::to_string);
    let Lost { missing, failed } = &found.lost;
    let missing = missing.iter().map(|cell| lost(cell, "missing"));
    let failed = failed.iter().map(|cell| lost(&cell.cell, "failed"));
    found.cells.iter().map(of).chain(missing).chain(failed).collect()
}

/// The comparison of one experiment as one object; that of several with the name of each.
fn object<T: Serialize>(found: &Compared<T>, limit: f64) -> Result<Value> {
    let with = |each: &T, key: &str, value: Value| {
        let mut object = json_of(each)?;
        object[key] = value;
        Ok::<Value, Error>(object)
    };
    match found.experiments.as_slice() {
        [(name, only)] if name.is_empty() => with(only, "limit", json!(limit)),
        several => {
            let named = several.iter().map(|(name, each)| with(each, "experiment", json!(name)));
            let [only_old, only_new] = &found.alone;
            let experiments = named.collect::<Result<Vec<Value>>>()?;
            Ok(json!({ "limit": limit, "experiments": experiments, "only_old": only_old, "only_new": only_new }))
        }
    }
}
