//! The plan of `pathmark claims --plan`: for each claim the command that measures its rows, with seconds and bytes.

use super::prelude::*;
use crate::experiment::{Definition, Options, Plan, Prices, Profile, Sweep, Theirs};
use crate::report::claims::{Needs, Report};
use crate::report::words;
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
    let mut plans: BTreeMap<String, std::result::Result<(String, Plan), String>> = BTreeMap::new();
    let (mut rows, mut tables) = (Vec::new(), Vec::new());
    for (report, claim) in reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim))) {
        let mut machine = "";
        let (command, costs, why) = match report.needs(claim) {
            Needs::Experiment(name) => {
                if !plans.contains_key(&name) {
                    let plan = match plan_of(lab, &name, folders, &mut prices) {
                        Ok(plan) => Ok(plan),
                        Err(Error::Input(error)) => Err(error.to_string()),
                        Err(other) => return Err(other),
                    };
                    plans.insert(name.clone(), plan);
                }
                match &plans[&name] {
                    Ok((command, plan)) => (command.clone(), (Some(plan.seconds()), Some(plan.bytes)), String::new()),
                    Err(why) => (String::new(), (None, None), why.clone()),
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
        let why = Some(row.why.clone()).filter(|_| !row.command.is_empty()).unwrap_or_default();
        let more = [words::costs(row.seconds, row.bytes, row.machine), why];
        let more = more.into_iter().filter(|part| !part.is_empty()).collect::<Vec<String>>().join(", ");
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
        print(&format!("\n{of}, each run once: {}", words::costs(Some(seconds), Some(bytes), "")))?;
    }
    if !tables.is_empty() {
        let told: Vec<f64> = tables.iter().filter_map(|table| table.seconds).collect();
        let (of, untold) = (counted(tables.len(), "table"), tables.len() - told.len());
        let seconds = (!told.is_empty()).then(|| words::costs(Some(told.iter().sum()), None, ""));
        let untold = (untold > 0).then(|| format!("{untold} without a time"));
        let told = [seconds, untold].into_iter().flatten().collect::<Vec<String>>().join(", ");
        print(&format!("\n{of} of other programs, as the ledger tells it: {told}"))?;
    }
    Ok(())
}

/// The command that measures an experiment, and its plan. The experiment is one of the program, that of rows in these
/// folders, or that of a definition in the current folder.
fn plan_of(lab: &Arc<Lab>, name: &str, folders: &[PathBuf], prices: &mut Prices<'_>) -> Result<(String, Plan)> {
    let file = format!("{name}.toml");
    let is_known = Definition::known(lab).any(|(known, _)| known == name);
    let measured = folders.iter().map(|folder| folder.join(name)).find(|own| own.join("experiment.toml").is_file());
    if let Some(folder) = measured.filter(|_| !is_known) {
        let plan = Theirs::read(lab, &folder)?.plan(&folder, prices)?;
        return Ok((shell::command(["replicate", &folder.display().to_string()]), plan));
    }
    if !is_known && !Path::new(&file).is_file() {
        let problem = format!("no experiment is called so, and there is no {file}");
        return Err(InputError::new("experiment", name, problem).into());
    }
    let asked = if is_known { name } else { &file };
    let definition = Definition::load(lab, asked)?;
    // The reports' size is that of the claims.
    let mut sizes = [Profile::Reports, Profile::Quick, Profile::Full].into_iter();
    let profile = sizes.find(|profile| definition.has(*profile)).unwrap_or_default();
    // Nothing is written there.
    let options = Options { out: PathBuf::from("out"), profile, ..Options::default() };
    let plan = Sweep::new(&definition, &options, &mut Files::default())?.plan(prices)?;
    Ok((shell::command(["run", asked, &format!("--{}", profile.name())]), plan))
}
