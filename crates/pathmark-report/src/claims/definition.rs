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
use super::plain_rows::PlainRows;
use super::statistic::{OF_PLAIN_ROWS, Statistic};
use super::verdict::{NAMES, Verdict};
use crate::error::{Error, InputError, Result};
use crate::experiment;
use crate::input::{locate, parse, read_text};
use crate::lab::Lab;
use serde::Deserialize;
use std::collections::BTreeSet;
use std::iter::once;
use std::path::{Path, PathBuf};

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
}

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

    /// The time at which the claim was fixed, as `2026-01-31T12:00:00Z`.
    pub(super) fn frozen_utc(&self) -> &str {
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

    /// Checks the claim, and reads its statistic; `tables` are the ledger's.
    fn resolve(&mut self, tables: &[PlainRows]) -> Result<()> {
        let is_finding = self.statistic.is_some() && !self.predicts() && self.frozen.is_empty();
        if let Some(field) = self.missing_field().filter(|_| !is_finding) {
            return Err(InputError::new("id", self.id.to_string(), format!("has no `{field}`")).into());
        }
        if !is_finding && !is_time(self.frozen_utc()) {
            return Err(InputError::new("frozen", &self.frozen, "does not begin with a time")
                .allowed("a time in UTC and perhaps a commit, for example 2026-01-31T12:00:00Z 0123abcd")
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
        let Some(name) = &self.statistic else {
            let unknown =
                |field: &String| InputError::new(field, "", "is no field of a claim without a statistic").into();
            return self.fields.keys().next().map_or(Ok(()), |field| Err(unknown(field)));
        };
        let statistic = Statistic::of(name, &self.fields)?;
        check_columns(&statistic, &self.comparable_if, tables)?;
        let predicted = match (self.within, self.at_least, self.at_most) {
            (Some([low, high]), None, None) if low <= high => Some([low, high]),
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
        for table in &report.tables {
            table.check().map_err(|error| match error {
                Error::Input(error) => {
                    let at = locate(text, &error.field, &error.value);
                    error.in_file(file, at).into()
                }
                other => other,
            })?;
        }
        for claim in &mut report.claims {
            let id = claim.id;
            claim.resolve(&report.tables).map_err(|error| match error {
                Error::Input(error) => {
                    let at = place(text, id, &error.field, &error.value);
                    error.in_file(file, at).into()
                }
                other => other,
            })?;
        }
        Ok(report)
    }

    /// Reads a ledger of somebody's own, or all of a folder in the order of their names. Numbers of claims and letters of
    /// reports must be unique.
    pub fn read(path: &Path) -> Result<Vec<Self>> {
        let files = Self::files(path)?;
        let of_file = |file: &PathBuf| {
            let name = file.display().to_string();
            Ok((Self::from_text(&name, &read_text(file)?)?, name))
        };
        Self::unique(files.iter().map(of_file))
    }

    /// The ledgers of some files, each with the name of its file.
    fn unique(ledgers: impl Iterator<Item = Result<(Self, String)>>) -> Result<Vec<Self>> {
        let (ledgers, files): (Vec<Self>, Vec<String>) = ledgers.collect::<Result<Vec<_>>>()?.into_iter().unzip();
        let mut letters = BTreeSet::new();
        let mut numbers = BTreeSet::new();
        for (file, ledger) in files.iter().zip(&ledgers) {
            let twice = |field: &str, value: String| {
                let problem = "occurs twice; numbers of claims and names of reports are unique over all ledgers";
                Err(InputError::new(field, value, problem).in_file(file, None).into())
            };
            if !letters.insert(&ledger.report) {
                return twice("report", ledger.report.clone());
            }
            if let Some(claim) = ledger.claims.iter().find(|claim| !numbers.insert(claim.id)) {
                return twice("id", claim.id.to_string());
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

    /// The ledgers that a program added to its lab, or else the four reports. Their numbers and letters must be unique.
    pub fn all(lab: &Lab) -> Result<Vec<Self>> {
        Self::unique(Self::texts(lab).iter().map(|(name, text)| {
            let name = format!("claims/{name}.toml");
            Ok((Self::from_text(&name, text)?, name))
        }))
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
    match all.find(|(_, column)| !known.iter().any(|own| own == column)) {
        None => Ok(()),
        Some((field, column)) => {
            let rows = table.map_or_else(|| "records.csv".to_string(), |table| format!("the table {}", table.name));
            let problem = format!("there is no such column in {rows}");
            Err(InputError::new(field, column, problem).allowed(known.join(", ")).into())
        }
    }
}

/// The ledgers of a folder, by name.
fn ledgers_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let system = |e| Error::system("reading", folder, e);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(system)? {
        let path = entry.map_err(system)?.path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Whether a text is a time such as `2026-01-31T12:00:00Z`: such texts are in the order of their times.
fn is_time(text: &str) -> bool {
    const FORM: &[u8] = b"0000-00-00T00:00:00Z";
    let fits = |(own, form): (u8, &u8)| if *form == b'0' { own.is_ascii_digit() } else { own == *form };
    text.len() == FORM.len() && text.bytes().zip(FORM).all(fits)
}

/// Line and column of a field's value in the claim with this number.
fn place(text: &str, id: u32, field: &str, value: &str) -> Option<(usize, usize)> {
    const HEAD: &str = "[[claim]]";
    let own = format!("id = {id}\n");
    let (start, part) = text.match_indices(HEAD).map(|(at, _)| at).find_map(|at| {
        let rest = &text[at + HEAD.len()..];
        let part = &rest[..rest.find(HEAD).unwrap_or(rest.len())];
        part.contains(&own).then_some((at + HEAD.len(), part))
    })?;
    let (line, column) = locate(part, field, value).or_else(|| locate(part, "id", &id.to_string()))?;
    Some((line + text[..start].matches('\n').count(), column))
}
