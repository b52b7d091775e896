//! `pathmark selftest`: the hard cases on this machine, and the costs of guarding against them.

use super::prelude::*;
use crate::check::guards::{GUARDS, Guard, GuardTimes};
use crate::check::{self, Case, Effort, Outcome, SECTIONS, case_row};
use crate::console::output::lock_folder;
use crate::experiment::{MACHINE, RunFile, read_run_file};
use crate::guard_prices::{FILE, FOLDER, PriceRow, read_prices, write_prices};
use crate::lock::{Lock, Sharing};
use crate::measure::available_threads;
use crate::{cases_file, report};
use std::process::Command;

/// Processes that time the guards.
const PROCESSES: u64 = 8;

/// `pathmark selftest --thorough`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Cases by name, as in S11 A6, or by first letter [default: all of them, and the price list of the guards]
    cases: Vec<String>,
    /// Try as many random inputs as the catalogue of hard cases specifies: minutes to hours
    #[arg(long)]
    thorough: bool,
    /// Write the cases, the price list of the guards and a page of all results into this folder, beside the results of experiments. An existing price
    /// list is kept
    #[arg(long, value_name = "DIR", conflicts_with = "cases")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Time the guards once: one process of their price list
    #[arg(long, hide = true)]
    guard_times: bool,
}

#[derive(Serialize)]
struct Row<'a> {
    id: &'static str,
    tries: &'static str,
    pass: bool,
    #[serde(flatten)]
    outcome: &'a Outcome,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    if arguments.guard_times {
        return print_json(&GUARDS.iter().map(Guard::times).collect::<Result<Vec<_>>>()?);
    }
    let chosen = chosen(&arguments.cases)?;
    let _lock = arguments.out.as_ref().map(|out| folder_for_results(out)).transpose()?;
    let effort = if arguments.thorough { Effort::Thorough } else { Effort::Quick };
    let outcomes = try_cases(&chosen, effort, console)?;
    let rows: Vec<Row<'_>> = chosen
        .iter()
        .zip(&outcomes)
        .map(|(case, outcome)| Row { id: case.id, tries: case.tries, pass: outcome.passed(), outcome })
        .collect();
    // Guards are timed alone, only if no cases are named, and once for each folder.
    let are_priced = arguments.out.as_ref().is_some_and(|out| has_prices(out));
    let prices = if arguments.cases.is_empty() && !are_priced { price_guards(console) } else { Vec::new() };
    if arguments.json {
        print_json(&serde_json::json!({ "cases": rows, "guards": prices }))?;
    } else {
        print(&table(&rows, !arguments.cases.is_empty()))?;
        if !prices.is_empty() {
            print(&price_list(&prices))?;
        }
    }
    if let Some(out) = &arguments.out {
        write_cases(out, lab, &chosen, &outcomes)?;
        if !are_priced {
            write_guards(out, lab, &prices)?;
        }
        let written = format!("report in {}", report::write(lab, out)?.display());
        // Standard output holds one JSON object then.
        if arguments.json {
            console.note(&written);
        } else {
            print(&written)?;
        }
    }
    let failed: Vec<&str> = rows.iter().filter(|row| !row.pass).map(|row| row.id).collect();
    if failed.is_empty() { Ok(()) } else { Err(Error::Check(format!("hard cases {}", failed.join(", ")))) }
}

/// Locks the folder of results if the cases, the price list and the page may be written into it. `reproduce` may have
/// left the price list there already.
fn folder_for_results(out: &Path) -> Result<Lock> {
    let mut files = Files::default();
    if !has_prices(out) || read_prices(&out.join(FOLDER).join(FILE))?.is_empty() {
        claim_guards(out, &mut files)?;
    }
    claim_cases(out, &mut files)?;
    report::claim("out", out, &mut files)?;
    lock_folder(out, Sharing::Shared)
}

/// The cases of these names or first letters, in the table's order.
fn chosen(names: &[String]) -> Result<Vec<&'static Case>> {
    for name in names {
        if !check::cases().any(|case| fits(case, name)) {
            let mut known: Vec<&str> = check::cases().map(|case| case.id).collect();
            known.sort_by_key(|id| numbered(id));
            let error = InputError::new("case", name, "there is no such case");
            return Err(error.allowed(known.join(", ")).into());
        }
    }
    Ok(check::cases().filter(|case| names.is_empty() || names.iter().any(|name| fits(case, name))).collect())
}

/// Whether a name is that of the case, with or without leading zeros, or the letter of its area.
fn fits(case: &Case, name: &str) -> bool {
    case.id == name
        || (name.len() == 1 && case.id.starts_with(name))
        || numbered(name).is_some_and(|number| numbered(case.id) == Some(number))
}

/// The letter and the number of a case's name.
fn numbered(id: &str) -> Option<(char, u32)> {
    Some((id.chars().next()?, id.get(1..)?.parse().ok()?))
}

/// The printed table: a line for each case, its failed or skipped trials, and with `in_full` all trials.
fn table(rows: &[Row<'_>], in_full: bool) -> String {
    let mut lines = Vec::new();
    for section in SECTIONS {
        let ids: Vec<&str> = section.cases.iter().map(|case| case.id).collect();
        let here: Vec<&Row<'_>> = rows.iter().filter(|row| ids.contains(&row.id)).collect();
        if !here.is_empty() {
            lines.push(format!("{}\n", section.title));
        }
        for row in here {
            lines.push(line(row));
            for trial in row.outcome.trials.iter().filter(|trial| in_full || !trial.passed) {
                let mark = if trial.passed { "    " } else { "  ! " };
                lines.push(format!("{mark}{}: expected {}, found {}", trial.variant, trial.expected, trial.found));
            }
            lines.extend(row.outcome.skipped.iter().map(|why| format!("    not tried: {why}")));
        }
        lines.push(String::new());
    }
    let trials: usize = rows.iter().map(|row| row.outcome.trials.len()).sum();
    let (failed, skipped) = (
        rows.iter().filter(|row| !row.pass).count(),
        rows.iter().filter(|row| row.outcome.trials.is_empty() && row.pass).count(),
    );
    lines.push(format!("{} cases, {trials} trials: {failed} failed, {skipped} not tried", rows.len()));
    lines.join("\n")
}

/// Name, verdict and subject of a case, and the expected and found result of a single trial.
fn line(row: &Row<'_>) -> String {
    let verdict = match (row.pass, row.outcome.trials.is_empty()) {
        (true, false) => "pass",
        (true, true) => "skip",
        (false, _) => "FAIL",
    };
    let what = match row.outcome.trials.as_slice() {
        [trial] => format!("expected {}, found {}", trial.expected, trial.found),
        trials => format!("{} trials", trials.len()),
    };
    format!("  {:4} {verdict}  {}: {what}", row.id, row.tries)
}

/// The guards, two lines each.
fn price_list(rows: &[PriceRow]) -> String {
    let mut lines = vec!["\nCost of the guards, and errors with and without them (95 % intervals)\n".to_string()];
    for row in rows {
        let times = match (row.time_ratio, row.time_ratio_low, row.time_ratio_high) {
            (Some(ratio), Some(low), Some(high)) => format!("{ratio:.2} times the time ({low:.2} to {high:.2})"),
            _ => "not timed".to_string(),
        };
        let times = row.share.map_or(times.clone(), |share| {
            format!("{times}, {:+.1} % of a sample of {} ({})", 100.0 * share, row.scene, row.often)
        });
        lines.push(format!("  {}: {} instead of {}, {times}", row.guard, row.with, row.without));
        lines.push(format!("    {}: {:.3e} instead of {:.3e}", row.error, row.error_with, row.error_without));
    }
    lines.join("\n")
}

/// Tries cases on all processors.
pub(super) fn try_cases(cases: &[&'static Case], effort: Effort, console: &Console) -> Result<Vec<Outcome>> {
    console.begin("hard cases", cases.len() as u64);
    let outcomes = check::run(cases, effort, available_threads(), &|done| console.advance(done))?;
    console.end();
    Ok(outcomes)
}

/// Adds the cases to the files that a command will write. Refuses a folder that has them.
pub(super) fn claim_cases(out: &Path, files: &mut Files) -> Result<()> {
    cases_file::claim(out, files)?;
    files.renews("out", &out.join(cases_file::FOLDER).join(MACHINE), |path| read_run_file(path).is_ok())
}

/// Writes the outcomes of some cases into a folder of results, with the command and the machine.
pub(super) fn write_cases(out: &Path, lab: &Lab, cases: &[&'static Case], outcomes: &[Outcome]) -> Result<()> {
    let rows: Vec<_> = cases.iter().zip(outcomes).map(|(case, outcome)| case_row(case, outcome)).collect();
    write_machine(&out.join(cases_file::FOLDER), lab)?;
    cases_file::write(out, &rows)
}

/// Writes the command and the machine into a folder of results, which is made if needed.
pub(super) fn write_machine(folder: &Path, lab: &Lab) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
    let program = lab.program().join(" ");
    RunFile { program, ..RunFile::of_now(crate::command_line()) }.write(&folder.join(MACHINE))
}

/// Whether a folder of results has the price list of the guards already.
pub(super) fn has_prices(out: &Path) -> bool {
    out.join(FOLDER).join(FILE).is_file()
}

/// Measures all guards in several processes: a process has one memory layout, which may favour one of two methods.
pub(super) fn price_guards(console: &Console) -> Vec<PriceRow> {
    console.begin("guards", PROCESSES);
    let mut processes: Vec<Vec<GuardTimes>> = vec![Vec::new(); GUARDS.len()];
    for done in 1..=PROCESSES {
        let own =
            std::env::current_exe().and_then(|own| Command::new(own).args(["selftest", "--guard-times"]).output());
        let times = own.ok().and_then(|output| serde_json::from_slice::<Vec<GuardTimes>>(&output.stdout).ok());
        for (all, own) in processes.iter_mut().zip(times.into_iter().flatten()) {
            all.push(own);
        }
        console.advance(done);
    }
    console.end();
    GUARDS.iter().zip(&processes).map(|(guard, processes)| guard.price(processes)).collect()
}

/// Adds the price list to the files that a command will write. Refuses a folder that has one: measurements are never
/// overwritten.
pub(super) fn claim_guards(out: &Path, files: &mut Files) -> Result<()> {
    let folder = out.join(FOLDER);
    files.renews("out", &folder.join(FILE), |_| false)?;
    files.renews("out", &folder.join(MACHINE), |path| read_run_file(path).is_ok())
}

/// Writes the price list into a folder of results, with the command and the machine.
pub(super) fn write_guards(out: &Path, lab: &Lab, rows: &[PriceRow]) -> Result<()> {
    let folder = out.join(FOLDER);
    write_machine(&folder, lab)?;
    write_prices(&folder.join(FILE), rows)
}
