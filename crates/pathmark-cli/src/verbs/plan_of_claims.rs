//! The plan of `pathmark claims --plan`: for each claim the command that measures its rows, with seconds and bytes.

use super::prelude::*;
use crate::experiment::{Definition, Options, Plan, Prices, Profile, Sweep, Theirs};
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
    /// Of the whole experiment or table, which may answer several claims.
    seconds: Option<f64>,
    bytes: Option<u64>,
    /// The machine on which it takes them, as a ledger tells it; empty for this machine.
    machine: &'a str,
    /// Why there is no command, or which rows of another program it measures.
    why: String,
}

/// Prints for each claim the command that measures its rows, and what it takes. `folders` are those of rows.
pub(super) fn plan(lab: &Arc<Lab>, reports: &[Report], folders: &[PathBuf], as_json: bool) -> Result<()> {
    let mut prices = Prices::new(lab);
    let mut plans: BTreeMap<String, Option<(String, Plan)>> = BTreeMap::new();
    let (mut rows, mut tables) = (Vec::new(), Vec::new());
    for (report, claim) in reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim))) {
        let mut machine = "";
        let (command, costs, why) = match report.needs(claim) {
            Needs::Experiment(name) => {
                if !plans.contains_key(&name) {
                    plans.insert(name.clone(), plan_of(lab, &name, folders, &mut prices)?);
                }
                if let Some((command, plan)) = plans.get(&name).cloned().flatten() {
                    (command, (Some(plan.seconds()), Some(plan.bytes)), String::new())
                } else {
                    let why = format!("no experiment is called {name}, and there is no {name}.toml");
                    (String::new(), (None, None), why)
                }
            }
            Needs::Table(table) => {
                machine = table.machine.as_deref().unwrap_or_default();
                if !tables.contains(&table) {
                    tables.push(table);
                }
                let why = format!("rows of another program, in {}", table.file);
                (table.command.clone().unwrap_or_default(), (table.seconds, table.bytes), why)
            }
            Needs::HardCases => (shell::command(["selftest", "--out", "out"]), (None, None), String::new()),
            Needs::Nothing(why) => (String::new(), (None, None), why),
        };
        let (seconds, bytes) = costs;
        let (claim, says) = (claim.id, claim.claim.as_str());
        rows.push(Planned { claim, report: &report.report, says, command, seconds, bytes, machine, why });
    }
    rows.sort_by_key(|row| row.claim);
    if as_json {
        return print_json(&rows);
    }
    let line = |row: &Planned<'_>| {
        let how = if row.command.is_empty() { format!("- {}", row.why) } else { row.command.clone() };
        let more = [
            row.seconds.map(|seconds| format!("{seconds:.0} s")),
            row.bytes.map(|bytes| format!("{:.1} MB", bytes as f64 / 1e6)),
            Some(row.machine).filter(|machine| !machine.is_empty()).map(|machine| format!("on {machine}")),
            Some(row.why.clone()).filter(|why| !why.is_empty() && !row.command.is_empty()),
        ];
        let more = more.into_iter().flatten().collect::<Vec<String>>().join(", ");
        let more = if more.is_empty() { more } else { format!("  # {more}") };
        format!("{:>3} {}  {}\n        {how}{more}", row.claim, row.report, row.says)
    };
    print(&rows.iter().map(line).collect::<Vec<String>>().join("\n"))?;
    let (mut seconds, mut bytes) = (0.0, 0);
    for (_, plan) in plans.values().flatten() {
        (seconds, bytes) = (seconds + plan.seconds(), bytes + plan.bytes);
    }
    let experiments = plans.values().flatten().count();
    if experiments > 0 {
        let of = counted(experiments, "experiment");
        print(&format!("\n{of}, each run once: about {seconds:.0} s, {:.0} MB", bytes as f64 / 1e6))?;
    }
    if !tables.is_empty() {
        let told: Vec<f64> = tables.iter().filter_map(|table| table.seconds).collect();
        let (of, untold) = (counted(tables.len(), "table"), tables.len() - told.len());
        let seconds = (!told.is_empty()).then(|| format!("{:.0} s", told.iter().sum::<f64>()));
        let untold = (untold > 0).then(|| format!("{untold} without a time"));
        let told = [seconds, untold].into_iter().flatten().collect::<Vec<String>>().join(", ");
        print(&format!("\n{of} of other programs, as the ledger tells it: {told}"))?;
    }
    Ok(())
}

/// The command that measures an experiment, and its plan; `None` if there is no such experiment. It is one of the program,
/// that of rows in these folders, or that of a definition in the current folder.
fn plan_of(lab: &Arc<Lab>, name: &str, folders: &[PathBuf], prices: &mut Prices<'_>) -> Result<Option<(String, Plan)>> {
    let file = format!("{name}.toml");
    let is_known = Definition::known(lab).any(|(known, _)| known == name);
    let measured = folders.iter().map(|folder| folder.join(name)).find(|own| own.join("experiment.toml").is_file());
    let (definition, profile, out, command) = match measured.filter(|_| !is_known) {
        Some(folder) => {
            let Theirs { definition, profile, .. } = Theirs::read(lab, &folder)?;
            (definition, profile, folder.join("again"), vec!["replicate".to_string(), folder.display().to_string()])
        }
        None if is_known || Path::new(&file).is_file() => {
            let asked: &str = if is_known { name } else { &file };
            let definition = Definition::load(lab, asked)?;
            // The reports' size is that of the claims.
            let mut sizes = [Profile::Reports, Profile::Quick, Profile::Full].into_iter();
            let profile = sizes.find(|profile| definition.has(*profile)).unwrap_or_default();
            let size = format!("--{}", profile.name());
            (definition, profile, PathBuf::from("out"), vec!["run".to_string(), asked.to_string(), size])
        }
        None => return Ok(None),
    };
    // Nothing is written there.
    let options = Options { out, profile, ..Options::default() };
    let plan = Sweep::new(&definition, &options, &mut Files::default())?.plan(prices)?;
    Ok(Some((shell::command(command.iter().map(String::as_str)), plan)))
}
