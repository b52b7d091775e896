//! The plan of `pathmark claims --plan`: for each claim the command that measures its rows, with seconds and bytes.

use super::prelude::*;
use crate::experiment::{Definition, Options, Plan, Prices, Profile, Sweep};
use crate::report::claims::{Needs, Report};
use crate::shell;
use std::collections::BTreeMap;

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
pub(super) fn plan(lab: &Arc<Lab>, reports: &[Report], as_json: bool) -> Result<()> {
    let mut prices = Prices::new(lab);
    let mut plans: BTreeMap<String, Option<(String, Plan)>> = BTreeMap::new();
    let mut rows = Vec::new();
    for (report, claim) in reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim))) {
        let (command, plan, why) = match report.needs(claim) {
            Needs::Experiment(name) => {
                if !plans.contains_key(&name) {
                    plans.insert(name.clone(), plan_of(lab, &name, &mut prices)?);
                }
                match plans.get(&name).cloned().flatten() {
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
