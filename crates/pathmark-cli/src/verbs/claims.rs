//! `pathmark claims`: the claims of the four reports, or of a ledger of one's own, beside the measurements.

use super::prelude::*;
use crate::experiment::{Definition, Options, Plan, Prices, Profile, Sweep};
use crate::report::claims::{self, Answer, Listing, Needs, Report, judge};
use crate::shell;
use std::collections::BTreeMap;

/// `pathmark claims out --report A`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders that `reproduce` or `run` wrote, each a run. Of several, all with rows under the report's conditions count; their order does not matter
    #[arg(default_value = "out", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Also write all verdicts into this folder, as CLAIMS.md and claims/claims.csv. Files that answer more claims are kept
    #[arg(long, value_name = "DIR", conflicts_with = "report")]
    out: Option<PathBuf>,
    /// Print only the claims of this report
    #[arg(long, value_name = "LETTER")]
    report: Option<String>,
    /// Judge the claims and findings of this file, or of all .toml files in this folder, instead of the four reports'. With
    /// `--out`, its name is that of the files: FINDINGS.md and claims/findings.csv for findings.toml
    #[arg(long, value_name = "FILE|DIR")]
    ledger: Option<PathBuf>,
    /// Print for each claim the command that measures its rows, with seconds and bytes, and judge none; run only a pilot
    #[arg(long, conflicts_with_all = ["out", "strict", "markdown"])]
    plan: bool,
    /// Print an array of objects
    #[arg(long)]
    json: bool,
    /// Print the text that `--out` writes
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    /// Exit with code 1 if a verdict differs from the expected one, or if its bound is not older than the rows that it judges
    #[arg(long)]
    strict: bool,
}

/// A verdict for other programs.
#[derive(Serialize)]
struct Row<'a> {
    claim: u32,
    report: &'a str,
    says: &'a str,
    verdict: &'static str,
    expected: &'a str,
    measured: String,
    /// The rule that made the value and its interval, with the number of units.
    rule: String,
    predicted: String,
    why: &'a str,
    runs: String,
    to_settle: String,
    age: &'static str,
    source: Option<String>,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    let (mut reports, listing) = match &arguments.ledger {
        None => (Report::all(lab)?, Listing::of_reports()),
        Some(path) => {
            let ledgers = Report::read(path)?;
            let listing = Listing::of_ledgers(path, &ledgers);
            (ledgers, listing)
        }
    };
    if let Some(letter) = &arguments.report {
        let known: Vec<String> = reports.iter().map(|report| report.report.clone()).collect();
        reports.retain(|report| report.report == *letter);
        if reports.is_empty() {
            return Err(InputError::new("report", letter, "there is no such report").allowed(known.join(", ")).into());
        }
    }
    if arguments.plan {
        return plan(lab, &reports, arguments.json);
    }
    for folder in &arguments.folders {
        if !folder.is_dir() {
            return Err(InputError::new("folder", folder.display().to_string(), "there is no such folder").into());
        }
    }
    if let Some(out) = &arguments.out {
        listing.enter("out", out, &mut Files::default())?;
    }
    let answers = judge(lab, &reports, &arguments.folders)?;
    if let Some(out) = &arguments.out {
        listing.check_no_loss("out", &answers, out)?;
        create_folder("out", out)?;
        listing.save(&answers, out)?;
    }
    if arguments.json {
        print_json(&answers.iter().map(row).collect::<Vec<_>>())?;
    } else if arguments.markdown {
        print(listing.markdown_of(&answers, Path::new(".")).trim_end())?;
    } else {
        print(&answers.iter().map(line).collect::<Vec<String>>().join("\n"))?;
        print(&format!("\n{} claims: {}", answers.len(), claims::totals(&answers)))?;
    }
    let of = |is_wrong: &dyn Fn(&Answer<'_>) -> bool, problem: &str| {
        let wrong: Vec<String> = answers.iter().filter(|a| is_wrong(a)).map(|a| a.claim.id.to_string()).collect();
        (!wrong.is_empty()).then(|| format!("claims {} {problem}", wrong.join(", ")))
    };
    let problems = [
        of(&|answer| answer.is_unexpected(), "have unexpected verdicts"),
        of(&|answer| answer.is_bound_younger(), "have bounds that are not older than the rows that they judge"),
    ];
    let problems: Vec<String> = problems.into_iter().flatten().collect();
    if arguments.strict && !problems.is_empty() {
        return Err(Error::Check(problems.join("; ")));
    }
    Ok(())
}

/// How the rows of a claim are measured.
#[derive(Serialize)]
struct Planned<'a> {
    claim: u32,
    report: &'a str,
    says: &'a str,
    /// Empty if this program cannot measure it.
    command: String,
    /// Of the whole experiment, which may answer several claims.
    seconds: Option<f64>,
    bytes: Option<u64>,
    /// Why there is no command.
    why: String,
}

/// Prints for each claim the command that measures its rows, and what it takes.
fn plan(lab: &Arc<Lab>, reports: &[Report], as_json: bool) -> Result<()> {
    let mut prices = Prices::new(lab);
    let mut plans: BTreeMap<String, Option<(String, Plan)>> = BTreeMap::new();
    let mut rows = Vec::new();
    for (report, claim) in reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim))) {
        let (command, plan, why) = match report.needs(claim) {
            Needs::Experiment(name) => {
                let planned = match plans.get(&name) {
                    Some(planned) => planned.clone(),
                    None => {
                        let planned = plan_of(lab, &name, &mut prices)?;
                        plans.entry(name.clone()).or_insert(planned).clone()
                    }
                };
                match planned {
                    Some((command, plan)) => (command, Some(plan), String::new()),
                    None => (String::new(), None, format!("no experiment is called {name}")),
                }
            }
            Needs::Table(file) => (String::new(), None, format!("rows of another program, in {file}")),
            Needs::HardCases => (shell::command(["selftest", "--out", "out"]), None, String::new()),
            Needs::Nothing(why) => (String::new(), None, why),
        };
        let (seconds, bytes) = (plan.as_ref().map(Plan::seconds), plan.map(|plan| plan.bytes));
        rows.push(Planned {
            claim: claim.id,
            report: &report.report,
            says: &claim.claim,
            command,
            seconds,
            bytes,
            why,
        });
    }
    rows.sort_by_key(|row| row.claim);
    if as_json {
        return print_json(&rows);
    }
    let line = |row: &Planned<'_>| {
        let costs = row.seconds.zip(row.bytes).map(|(s, bytes)| format!("  # {s:.0} s, {:.1} MB", bytes as f64 / 1e6));
        let how = if row.command.is_empty() { format!("- {}", row.why) } else { row.command.clone() };
        format!("{:>3} {}  {}\n        {how}{}", row.claim, row.report, row.says, costs.unwrap_or_default())
    };
    print(&rows.iter().map(line).collect::<Vec<String>>().join("\n"))?;
    let (mut seconds, mut bytes) = (0.0, 0);
    for (_, plan) in plans.values().flatten() {
        (seconds, bytes) = (seconds + plan.seconds(), bytes + plan.bytes);
    }
    let of = counted(plans.values().flatten().count(), "experiment");
    print(&format!("\n{of}, each run once: about {seconds:.0} s, {:.0} MB", bytes as f64 / 1e6))
}

/// The command of an experiment at the reports' size, or else at the quick one, and its plan; `None` if there is no such
/// experiment.
fn plan_of(lab: &Arc<Lab>, name: &str, prices: &mut Prices<'_>) -> Result<Option<(String, Plan)>> {
    if !Definition::known(lab).any(|(known, _)| known == name) {
        return Ok(None);
    }
    let definition = Definition::load(lab, name)?;
    let (profile, size) =
        if definition.has(Profile::Reports) { (Profile::Reports, "--reports") } else { (Profile::Quick, "--quick") };
    let options = Options { out: PathBuf::from("out"), profile, ..Options::default() };
    let plan = Sweep::new(&definition, &options, &mut Files::default())?.plan(prices)?;
    Ok(Some((shell::command(["run", name, size]), plan)))
}

fn row<'a>(answer: &'a Answer<'_>) -> Row<'a> {
    Row {
        claim: answer.claim.id,
        report: &answer.report.report,
        says: &answer.claim.claim,
        verdict: answer.verdict.name(),
        expected: &answer.claim.expected,
        measured: answer.measured(),
        rule: answer.rule(),
        predicted: answer.predicted(),
        why: &answer.why,
        runs: answer.in_runs(),
        to_settle: answer.settled_by(),
        age: answer.age(),
        source: answer.source(),
    }
}

fn line(answer: &Answer<'_>) -> String {
    let claim = answer.claim;
    let numbers = match answer.source() {
        Some(_) => format!("{}, predicted {}; {}", answer.measured(), answer.predicted(), answer.rule()),
        None => String::new(),
    };
    let notes = [answer.in_runs(), answer.settled_by(), answer.age().to_string()];
    let notes: Vec<String> = notes.into_iter().filter(|note| !note.is_empty()).collect();
    let more = [numbers, notes.join("; "), answer.why.clone()].into_iter().filter(|line| !line.is_empty());
    let head = format!("{:>3} {}  {:15} {}", claim.id, answer.report.report, answer.verdict.to_string(), claim.claim);
    std::iter::once(head).chain(more).collect::<Vec<String>>().join("\n        ")
}
