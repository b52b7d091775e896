//! The text of the claims: one file for each report, embedded like the experiments.
//!
//! ```toml
//! report = "A"
//! title = "MultiThreaded PathTracer"
//! about = "Who wrote it, and what was measured on which machine."
//!
//! [[claim]]
//! id = 5
//! quote = "words of the report, verbatim"
//! place = "Results, table of render times"
//! reported = "71, 166, 369, 687 and 1681 s at 8, 20, 40, 80 and 200 spp"
//! claim = "Render time is linear in samples per pixel."
//! experiment = "spp-quality"              # the folder whose rows answer
//! rows = { strategy = "thread-per-row" }  # columns of records.csv and the values wanted; a list means any of them
//! statistic = "exponent"                  # see `Statistic`
//! x = "spp"
//! y = "makespan_s"
//! unit = "repetition"                     # the independent units: repetition (the default), seed or scene
//! within = [0.9, 1.1]                     # the report's prediction; or at-least, or at-most
//! reason = "why the prediction ends there, without looking at rows"
//! level = 0.95                            # of the interval that is compared with it
//! comparable-if = { width = 1024, height = 768 }
//! expected = "confirmed"
//! frozen = "2026-11-27T21:14:47Z 634521b2" # when query, prediction and expectation were fixed, and in which commit
//! ```
//!
//! A ledger of another paper also tells its `source` and `doi`, and names rows of other programs (see `plain_rows.rs`).
//!
//! Optional: `changed`, the reason for a change after the first version, `a-fortiori = true`, if the bound holds under any conditions, and `note`. Instead of a
//! statistic a claim may have `context` (why there is nothing to measure), `not-comparable` (which condition of the report cannot be met) or `missing` (why
//! no rows exist yet). A statistic without a prediction is a finding: a number of one's own, which needs neither quote nor reason nor expectation.
//!
//! Who changes a query, a prediction or an expectation writes the time into `frozen`: rows that were measured before cannot confirm or refute the claim in
//! `claims --strict`. A commit cannot contain its own hash, so the next one adds it.

use super::condition::{Conditions, known_columns};
use super::places::{Part, place};
use super::plain_rows::PlainRows;
use super::statistic::{OF_PLAIN_ROWS, Statistic, fields_of, is_field_of_any};
use super::verdict::{NAMES, Verdict};
use crate::error::{Error, InputError, Result};
use crate::experiment;
use crate::files::entries;
use crate::input::{optional_array, parse, read_text};
use crate::lab::Lab;
use crate::time::{FORM, is_time};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::iter::once;
use std::path::{Component, Path, PathBuf};

/// The evidence that answers a claim.
#[derive(Debug, Clone, PartialEq)]
pub enum Needs<'a> {
    /// Rows of that experiment.
    Experiment(String),
    /// Rows of another program.
    Table(&'a PlainRows),
    /// Hard cases or the price list of the guards.
    HardCases,
    /// Nothing that can be measured, and why.
    Nothing(String),
}

/// A report and its claims.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Its letter.
    pub report: String,
    pub title: String,
    /// Its authors and its measurements.
    pub about: String,
    /// Authors, title, year and publisher, as one cites it; may be empty.
    #[serde(default)]
    pub source: String,
    #[serde(default)]
    pub doi: String,
    /// Rows of other programs.
    #[serde(default, rename = "table")]
    pub(super) tables: Vec<PlainRows>,
    #[serde(rename = "claim")]
    pub claims: Vec<Claim>,
    #[serde(skip)]
    origin: Origin,
}

/// Where a ledger came from, for errors about it.
#[derive(Debug, Default)]
struct Origin {
    file: String,
    text: String,
    /// Whether a user wrote it.
    is_own: bool,
}

/// The fields of a claim beside those of its statistic.
const FIELDS: [&str; 20] = [
    "id",
    "quote",
    "place",
    "reported",
    "claim",
    "expected",
    "frozen",
    "changed",
    "reason",
    "note",
    "context",
    "not-comparable",
    "missing",
    "statistic",
    "within",
    "at-least",
    "at-most",
    "level",
    "comparable-if",
    "a-fortiori",
];

/// A claim as it is written; `Claim::test` says how it is judged.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Claim {
    /// Its number, from 1, unique over all reports.
    pub id: u32,
    /// The report's words; like the next fields empty for a finding.
    #[serde(default)]
    pub quote: String,
    /// Their place in the report.
    #[serde(default)]
    pub place: String,
    /// The report's numbers.
    #[serde(default)]
    pub reported: String,
    /// The sentence that is tested.
    pub claim: String,
    /// The expected verdict of a run at the report's own size. Two names with ` or ` between them mean that the value
    /// is so near the limit that noise decides.
    #[serde(default)]
    pub expected: String,
    /// The time in UTC at which query, prediction and expectation were fixed, and the commit if it is known.
    #[serde(default)]
    frozen: String,
    /// The reason for a change after the first version; empty if there was none.
    #[serde(default)]
    pub changed: String,
    /// Why the prediction ends where it does.
    #[serde(default)]
    pub reason: String,
    /// A remark for the reader.
    #[serde(default)]
    pub note: String,
    context: Option<String>,
    not_comparable: Option<String>,
    missing: Option<String>,
    statistic: Option<String>,
    #[serde(default, deserialize_with = "optional_array")]
    within: Option<[f64; 2]>,
    at_least: Option<f64>,
    at_most: Option<f64>,
    level: Option<f64>,
    #[serde(default)]
    comparable_if: Conditions,
    #[serde(default)]
    a_fortiori: bool,
    /// The fields of the statistic.
    #[serde(flatten)]
    fields: toml::Table,
    #[serde(skip)]
    test: Option<Test>,
}

/// A statistic of measured rows, and the values that the report's claim predicts for it.
#[derive(Debug)]
pub(super) struct Test {
    pub(super) statistic: Statistic,
    /// The ends of the prediction; a side without a limit is infinite. A finding has none.
    pub(super) predicted: Option<[f64; 2]>,
    /// Confidence level of the interval.
    pub(super) level: f64,
    pub(super) comparable_if: Conditions,
    pub(super) a_fortiori: bool,
}

impl Claim {
    /// The statistic to compare with the prediction, or else the verdict without one and its reason.
    pub(super) fn test(&self) -> std::result::Result<&Test, (Verdict, &str)> {
        let missing = (Verdict::NotAnswered, self.missing.as_deref().unwrap_or_default());
        let unmet = self.not_comparable.as_deref().map_or(missing, |why| (Verdict::NotComparable, why));
        let without = self.context.as_deref().map_or(unmet, |why| (Verdict::Context, why));
        self.test.as_ref().ok_or(without)
    }

    pub(super) fn expected_verdicts(&self) -> impl Iterator<Item = &str> {
        self.expected.split(" or ")
    }

    /// The time at which the claim was fixed, as `2026-01-31T12:00:00Z`; empty for a finding.
    pub fn frozen_utc(&self) -> &str {
        self.frozen.split(' ').next().unwrap_or_default()
    }

    /// When, and if told in which commit, the claim was fixed.
    pub(super) fn fixed(&self) -> String {
        let commit = self.frozen.split_once(' ').map(|(_, commit)| format!(" in commit {commit}"));
        format!("{}{}", self.frozen_utc(), commit.unwrap_or_default())
    }

    /// The first field that every claim but a finding needs, and that this one lacks.
    fn missing_field(&self) -> Option<&'static str> {
        let needed = [
            ("quote", &self.quote),
            ("place", &self.place),
            ("reported", &self.reported),
            ("expected", &self.expected),
            ("frozen", &self.frozen),
        ];
        needed.into_iter().find(|(_, value)| value.is_empty()).map(|(name, _)| name)
    }

    fn predicts(&self) -> bool {
        self.within.is_some() || self.at_least.is_some() || self.at_most.is_some()
    }

    /// Refuses a field that neither claims nor the claim's statistic have.
    fn check_fields(&self) -> Result<()> {
        let (own, of) = match self.statistic.as_deref() {
            None => (Vec::new(), "a claim without a statistic".to_string()),
            Some(name) => match fields_of(name) {
                Some(own) => (own, format!("a claim with the statistic {name}")),
                // `Statistic::of` names those that there are.
                None => return Ok(()),
            },
        };
        let of_no_statistic = self.fields.keys().find(|field| !is_field_of_any(field));
        let Some(field) = of_no_statistic.or_else(|| self.fields.keys().find(|field| !own.contains(&field.as_str())))
        else {
            return Ok(());
        };
        let known: Vec<&str> = FIELDS.into_iter().chain(own).collect();
        Err(InputError::new("field", field, format!("{of} has no such field")).allowed(known.join(", ")).into())
    }

    /// Refuses ends of a prediction that no number can be compared with.
    fn check_prediction(&self) -> Result<()> {
        let sides = [("at-least", self.at_least), ("at-most", self.at_most)];
        let sides = sides.into_iter().filter_map(|(field, end)| Some((field, end?)));
        let mut ends = self.within.into_iter().flatten().map(|end| ("within", end)).chain(sides);
        if let Some((field, end)) = ends.find(|(_, end)| !end.is_finite()) {
            return Err(InputError::new(field, end.to_string(), "is no end of a prediction")
                .allowed("a finite number; at-least and at-most leave the other side open")
                .into());
        }
        match self.within {
            Some([low, high]) if low > high => {
                let value = format!("[{low}, {high}]");
                Err(InputError::new("within", value, "ends below its beginning").allowed("[low, high]").into())
            }
            _ => Ok(()),
        }
    }

    /// Checks the claim, and reads its statistic; `tables` are the ledger's.
    fn resolve(&mut self, tables: &[PlainRows]) -> Result<()> {
        if self.id == 0 {
            return Err(InputError::new("id", "0", "is no number of a claim").allowed("1 to 4294967295").into());
        }
        self.check_fields()?;
        self.check_prediction()?;
        if self.claim.trim().is_empty() {
            return Err(InputError::new("claim", "", "is empty").allowed("the sentence that is tested").into());
        }
        let is_finding = self.statistic.is_some() && !self.predicts() && self.frozen.is_empty();
        if let Some(field) = self.missing_field().filter(|_| !is_finding) {
            return Err(InputError::new("id", self.id.to_string(), format!("has no `{field}`")).into());
        }
        if !is_finding && !is_time(self.frozen_utc()) {
            return Err(InputError::new("frozen", &self.frozen, "does not begin with a time")
                .allowed(format!("{FORM}, and perhaps a commit after it, such as 0123abcd"))
                .into());
        }
        let without = [&self.context, &self.not_comparable, &self.missing];
        let kinds = once(self.statistic.is_some()).chain(without.map(Option::is_some));
        if kinds.filter(|is_there| *is_there).count() != 1 {
            return Err(InputError::new("id", self.id.to_string(), "has not exactly one kind of evidence")
                .allowed("a statistic, a context, a not-comparable or a missing")
                .into());
        }
        if !is_finding && !self.expected_verdicts().all(|name| NAMES.contains(&name)) {
            let problem = "is neither the name of a verdict nor names with ` or ` between them";
            return Err(InputError::new("expected", &self.expected, problem).allowed(NAMES.join(", ")).into());
        }
        let Some(name) = &self.statistic else { return Ok(()) };
        let statistic = Statistic::of(name, &self.fields)?;
        check_columns(&statistic, &self.comparable_if, tables)?;
        let predicted = match (self.within, self.at_least, self.at_most) {
            (Some(ends), None, None) => Some(ends),
            (None, Some(low), None) => Some([low, f64::INFINITY]),
            (None, None, Some(high)) => Some([f64::NEG_INFINITY, high]),
            (None, None, None) if is_finding => None,
            _ => {
                return Err(InputError::new("id", self.id.to_string(), "has not exactly one prediction")
                    .allowed(
                        "within = [low, high], at-least = low or at-most = high; a finding has none, and no `frozen`",
                    )
                    .into());
            }
        };
        let Some(level) = self.level else {
            let problem = "has a statistic, and no level for its interval";
            return Err(InputError::new("id", self.id.to_string(), problem).allowed("level = 0.95").into());
        };
        if !(level > 0.0 && level < 1.0) {
            return Err(InputError::new("level", level.to_string(), "is not a confidence")
                .allowed("between 0 and 1")
                .into());
        }
        if self.reason.is_empty() && !is_finding && !matches!(statistic, Statistic::Case(_)) {
            let problem = "has a prediction, and no reason for its ends";
            return Err(InputError::new("id", self.id.to_string(), problem).allowed("reason = \"...\"").into());
        }
        let comparable_if = std::mem::take(&mut self.comparable_if);
        self.test = Some(Test { statistic, predicted, level, comparable_if, a_fortiori: self.a_fortiori });
        Ok(())
    }
}

impl Report {
    /// Reads a report's claims from their text.
    pub fn from_text(file: &str, text: &str) -> Result<Self> {
        let mut report: Self = parse(text, file)?;
        report.origin = Origin { file: file.to_string(), text: text.to_string(), is_own: false };
        report.check_head().map_err(|error| report.located(Part::Head, error))?;
        for (index, table) in report.tables.iter().enumerate() {
            let is_twice = report.tables[..index].iter().any(|other| other.name == table.name);
            let twice = || Err(InputError::new("name", &table.name, "is the name of two tables").into());
            let checked = if is_twice { twice() } else { table.check() };
            checked.map_err(|error| report.located(Part::Table(index), error))?;
        }
        let mut claims = std::mem::take(&mut report.claims);
        for (index, claim) in claims.iter_mut().enumerate() {
            claim.resolve(&report.tables).map_err(|error| report.located(Part::Claim(index), error))?;
        }
        report.claims = claims;
        Ok(report)
    }

    fn check_head(&self) -> Result<()> {
        for (field, value) in [("report", &self.report), ("title", &self.title)] {
            if value.trim().is_empty() || value.contains(['\n', '\r']) {
                return Err(InputError::new(field, value, "is not one line of text").allowed("a name").into());
            }
        }
        if self.claims.is_empty() {
            return Err(InputError::new("claim", "", "there is none").allowed("one [[claim]] or more").into());
        }
        Ok(())
    }

    /// An error with its place, unless it has one.
    pub(super) fn located(&self, part: Part, error: Error) -> Error {
        match error {
            Error::Input(error) if error.place.is_none() => {
                let Origin { file, text, .. } = &self.origin;
                // The fault is the name of the field.
                let (field, value) =
                    if error.field == "field" { (&error.value, "") } else { (&error.field, &*error.value) };
                let at = place(text, part, field, value);
                error.in_file(file, at).into()
            }
            other => other,
        }
    }

    /// Whether a user wrote the ledger, so that an unanswered claim may be a typing error.
    pub(super) fn is_own(&self) -> bool {
        self.origin.is_own
    }

    /// Reads a ledger of somebody's own, or all of a folder in the order of their names. Numbers of claims and letters of
    /// reports must be unique.
    pub fn read(path: &Path) -> Result<Vec<Self>> {
        let files = Self::files(path)?;
        let of_file = |file: &PathBuf| {
            let mut ledger = Self::from_text(&file.display().to_string(), &read_text(file)?)?;
            ledger.origin.is_own = true;
            Ok(ledger)
        };
        Self::unique(files.iter().map(of_file).collect::<Result<_>>()?)
    }

    fn unique(ledgers: Vec<Self>) -> Result<Vec<Self>> {
        let mut letters = BTreeSet::new();
        let mut numbers = BTreeSet::new();
        for ledger in &ledgers {
            let twice = |part: Part, field: &str, value: String| {
                let problem = "occurs twice; numbers of claims and names of reports are unique over all ledgers";
                Err(ledger.located(part, InputError::new(field, value, problem).into()))
            };
            if !letters.insert(&ledger.report) {
                return twice(Part::Head, "report", ledger.report.clone());
            }
            if let Some(index) = ledger.claims.iter().position(|claim| !numbers.insert(claim.id)) {
                return twice(Part::Claim(index), "id", ledger.claims[index].id.to_string());
            }
        }
        Ok(ledgers)
    }

    /// The file of a ledger, or the files of a folder of ledgers by name.
    pub(crate) fn files(path: &Path) -> Result<Vec<PathBuf>> {
        let files = if path.is_dir() { ledgers_in(path)? } else { vec![path.to_path_buf()] };
        if files.is_empty() {
            let problem = "has no .toml file, so it is no folder of ledgers";
            return Err(InputError::new("ledger", path.display().to_string(), problem).into());
        }
        Ok(files)
    }

    /// Refuses rows outside of the folders that are judged, before any is read.
    pub(crate) fn check_paths(&self) -> Result<()> {
        let tables = self.tables.iter().enumerate().map(|(index, own)| (Part::Table(index), "file", own.file.clone()));
        let of_claim = |(index, claim)| match self.needs(claim) {
            Needs::Experiment(name) => Some((Part::Claim(index), "experiment", name)),
            Needs::Table(_) | Needs::HardCases | Needs::Nothing(_) => None,
        };
        let mut paths = tables.chain(self.claims.iter().enumerate().filter_map(of_claim));
        let is_outside = |path: &str| {
            Path::new(path).components().any(|part| !matches!(part, Component::Normal(_) | Component::CurDir))
        };
        let Some((part, field, outside)) = paths.find(|(_, _, path)| is_outside(path)) else { return Ok(()) };
        let error = InputError::new(field, outside, "leads out of the archive").allowed("relative paths without `..`");
        Err(self.located(part, error.into()))
    }

    /// The ledgers that a program added to its lab, or else the four reports. Their numbers and letters must be unique.
    pub fn all(lab: &Lab) -> Result<Vec<Self>> {
        let texts = Self::texts(lab).iter();
        let ledgers = texts.map(|(name, text)| Self::from_text(&format!("claims/{name}.toml"), text));
        Self::unique(ledgers.collect::<Result<_>>()?)
    }

    /// The names and texts of these ledgers.
    pub(crate) fn texts(lab: &Lab) -> &[(String, String)] {
        let own = lab.own_claims();
        if own.is_empty() { experiment::claims() } else { own }
    }

    /// The evidence that answers a claim of this ledger.
    pub fn needs(&self, claim: &Claim) -> Needs<'_> {
        match claim.test().map(|test| &test.statistic) {
            Err((_, why)) => Needs::Nothing(why.to_string()),
            Ok(Statistic::OfRows { experiment, .. }) => match self.table(experiment) {
                Some(table) => Needs::Table(table),
                None => Needs::Experiment(experiment.clone()),
            },
            Ok(Statistic::Case(_) | Statistic::Guard(_)) => Needs::HardCases,
        }
    }

    /// The table of another program's rows that a claim of this ledger asks for.
    pub(super) fn table(&self, experiment: &str) -> Option<&PlainRows> {
        self.tables.iter().find(|table| table.name == experiment)
    }
}

/// Refuses a column that the rows of a statistic do not have.
fn check_columns(statistic: &Statistic, comparable_if: &Conditions, tables: &[PlainRows]) -> Result<()> {
    let Statistic::OfRows { experiment, kind, .. } = statistic else { return Ok(()) };
    let table = tables.iter().find(|table| table.name == *experiment);
    if table.is_some() && kind.is_of_own_rows() {
        let problem = "asks for columns that only Pathmark's rows have";
        return Err(InputError::new("experiment", experiment, problem).allowed(OF_PLAIN_ROWS).into());
    }
    let known = table.map_or_else(known_columns, |table| table.columns().map(str::to_string).collect());
    let own = statistic.columns().into_iter();
    let mut all = own.chain(comparable_if.columns().map(|column| ("comparable-if", column)));
    let Some((field, column)) = all.find(|(_, column)| !known.iter().any(|own| own == column)) else { return Ok(()) };
    // The name of the table is wrong if another table has the column.
    let others: Vec<&str> = tables.iter().map(|table| table.name.as_str()).collect();
    if table.is_none() && tables.iter().any(|table| table.columns().any(|own| own == column)) {
        let problem = format!("is no table of this ledger, and rows of an experiment have no column {column}");
        return Err(InputError::new("experiment", experiment, problem).allowed(others.join(", ")).into());
    }
    let rows = table.map_or_else(|| "records.csv".to_string(), |table| format!("the table {}", table.name));
    let problem = format!("there is no such column in {rows}");
    Err(InputError::new(field, column, problem).allowed(known.join(", ")).into())
}

/// The ledgers of a folder, by name.
fn ledgers_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = entries(folder)?;
    files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A claim reads each field of the list.
    #[test]
    fn a_claim_reads_the_listed_fields() {
        for field in FIELDS {
            let values = ["1", "\"a\"", "true", "[1, 2]", "{}"].map(|value| format!("{field} = {value}\n"));
            let of_claim = |own: &String| {
                let needed =
                    ["id = 1\n", "claim = \"c\"\n"].into_iter().filter(|line| !line.starts_with(&format!("{field} =")));
                let claim = toml::from_str::<Claim>(&format!("{}{own}", needed.collect::<String>()));
                claim.is_ok_and(|claim| claim.fields.is_empty())
            };
            assert!(values.iter().any(of_claim), "{field}");
        }
        let fields = toml::from_str::<Claim>("id = 1\nclaim = \"c\"\nat_least = 1\n").unwrap().fields;
        assert_eq!(fields.len(), 1);
    }
}
