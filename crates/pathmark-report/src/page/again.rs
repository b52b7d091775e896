//! The commands that run a part of an experiment again, as the page offers them.

use crate::digest;
use crate::experiment::{Definition, Profile};
use crate::measure::Setting;
use crate::results::Results;
use crate::rows::Row;
use crate::schedule::strategy;
use crate::shell;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The parts of such a command, each quoted for a shell. The page's script only joins them.
#[derive(Serialize)]
pub(crate) struct Again {
    /// The command without filters.
    run: String,
    /// The filter that leads to a name in figures.
    filters: BTreeMap<String, String>,
    /// The end of the command: another folder, because rows are never overwritten.
    out: &'static str,
}

/// A new folder for each run.
const OUT: &str = "--out \"$(mktemp -d)\"";

impl Again {
    /// The commands for an experiment. `None` if there is none that would run the same cells: its file is gone or was
    /// edited, or this build cannot run it.
    pub(crate) fn of(results: &Results) -> Option<Self> {
        let (run, definition) = (&results.run, &results.definition);
        let asked = if run.experiment.is_empty() { &definition.name } else { &run.experiment };
        let now = Definition::load(&definition.lab, asked).ok()?.with_values(&run.set).ok()?;
        if digest::of_text(&now.text) != run.definition_hash || now.missing_feature().is_some() {
            return None;
        }
        let profile = Profile::from_name(&run.profile)?;
        let filters = filters(results, &now, profile)?;
        // A path that begins with a hyphen would be read as an option.
        let asked = if asked.starts_with('-') { format!("./{asked}") } else { asked.clone() };
        let values = run.set.iter().flat_map(|pair| ["--set".to_string(), pair.clone()]);
        let words = ["run".to_string(), asked, format!("--{}", profile.name())];
        Some(Self { run: shell::command(words.into_iter().chain(values)), filters, out: OUT })
    }

    /// The command for all cells.
    pub(super) fn whole(&self) -> String {
        format!("{} {}", self.run, self.out)
    }
}

/// The axes whose values figures name, each with the name that a row shows for it.
fn shown(row: &Row) -> [(&'static str, &str); 8] {
    [
        ("scene", &row.scene),
        ("estimator", &row.estimator),
        ("sampler", &row.sampler),
        ("kernel", &row.kernel),
        ("accelerator", &row.accelerator),
        ("decomposition", &row.decomposition),
        ("output", &row.output),
        ("strategy", strategy(row.as_written())),
    ]
}

/// The filter for each name that stands for one value of one axis. Rows show what was used, such as a scene's stem;
/// filters compare with what was asked for, such as the path of its file, or nothing where the program chose.
fn filters(results: &Results, definition: &Definition, profile: Profile) -> Option<BTreeMap<String, String>> {
    let cells = definition.cells(profile).ok()?;
    let points = cells.iter().flat_map(|cell| cell.points.iter().map(move |point| (point.id.as_str(), cell)));
    let by_id: HashMap<&str, _> = points.collect();
    let mut found: BTreeMap<&str, BTreeSet<(&str, String)>> = BTreeMap::new();
    for row in results.rows() {
        let Some(cell) = by_id.get(row.cell.as_str()) else { continue };
        for (axis, name) in shown(row) {
            let asked = Setting::named(axis).map(|axis| cell.shown(axis)).unwrap_or_default();
            found.entry(name).or_default().insert((axis, asked));
        }
    }
    let filter = |(name, values): (&str, BTreeSet<(&str, String)>)| match values.first() {
        // A comma would separate two values.
        Some((axis, value)) if values.len() == 1 && !value.is_empty() && !value.contains(',') => {
            Some((name.to_string(), format!("--filter {}", shell::quoted(&format!("{axis}={value}")))))
        }
        _ => None,
    };
    Some(found.into_iter().filter_map(filter).collect())
}
