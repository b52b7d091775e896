//! Rows that a claim asks for and that no folder has: in a user's ledger this may be a typing error.

use super::condition::{Columns, Conditions, text};
use super::definition::Report;
use super::judge::Answer;
use super::measure::Evidence;
use super::places::Part;
use super::statistic::Statistic;
use crate::error::{Error, InputError, Result};
use std::collections::BTreeSet;

/// The largest number of values that an error lists.
const MOST: usize = 20;

/// A value that a claim names and that no row has.
struct Absent {
    /// The claim's field, with the column: `rows.program`.
    field: String,
    value: String,
    /// The values that occur in this column.
    known: String,
}

impl Absent {
    /// The first such value of a statistic.
    fn of(statistic: &Statistic, evidence: &[&Evidence]) -> Option<Self> {
        let Statistic::OfRows { rows: own, kind, .. } = statistic else { return None };
        let rows: Vec<&Columns> = evidence.iter().flat_map(|own| own.columns()).collect();
        let of = |field: &str, conditions: &Conditions| {
            let (column, value) = conditions.absent(&rows)?;
            let known: BTreeSet<String> =
                rows.iter().map(|row| text(row, column)).filter(|own| !own.is_empty()).collect();
            let more = known.len().saturating_sub(MOST);
            let mut shown: Vec<String> = known.into_iter().take(MOST).collect();
            if more > 0 {
                shown.push(format!("and {more} more"));
            }
            Some(Self { field: format!("{field}.{column}"), value, known: shown.join(", ") })
        };
        of("rows", own).or_else(|| of("over", kind.over()?))
    }
}

/// Refuses a value that no row of another program's table has. `index` is the claim's in its ledger.
pub(super) fn check_values(report: &Report, index: usize, statistic: &Statistic, evidence: &[&Evidence]) -> Result<()> {
    let Statistic::OfRows { experiment, .. } = statistic else { return Ok(()) };
    if evidence.is_empty() || report.table(experiment).is_none() {
        return Ok(());
    }
    match Absent::of(statistic, evidence) {
        None => Ok(()),
        Some(Absent { field, value, known }) => {
            let problem = format!("occurs in no row of the table {experiment}");
            let error = InputError::new(field, value, problem).allowed(known);
            Err(report.located(Part::Claim(index), error.into()))
        }
    }
}

/// Why no rows answer a claim.
pub(super) fn why(report: &Report, statistic: &Statistic, evidence: &[&Evidence]) -> String {
    let usual = || "The results have no such rows.".to_string();
    let Statistic::OfRows { experiment, .. } = statistic else { return usual() };
    if !report.is_own() {
        return usual();
    }
    if evidence.is_empty() {
        return match report.table(experiment) {
            Some(table) => format!("No judged folder has the file {}.", table.file),
            None => format!("No judged folder has rows of {experiment}."),
        };
    }
    match Absent::of(statistic, evidence) {
        Some(Absent { field, value, known }) => format!("No row has {field} = {value}; there are {known}."),
        None => usual(),
    }
}

/// The error that no folder has the file of a table.
pub(super) fn lacking_file(report: &Report, statistic: &Statistic, evidence: &[&Evidence]) -> Option<InputError> {
    let Statistic::OfRows { experiment, .. } = statistic else { return None };
    let index = report.tables.iter().position(|table| table.name == *experiment).filter(|_| evidence.is_empty())?;
    let error = InputError::new("file", &report.tables[index].file, "is in none of the judged folders")
        .allowed("the path of a CSV file within a judged folder, or claims that expect `not-answered`");
    match report.located(Part::Table(index), error.into()) {
        Error::Input(error) => Some(*error),
        _ => None,
    }
}

/// Refuses a table whose file no folder has, if a verdict was expected: unless other claims have rows, or if `is_strict`.
pub fn check_files(answers: &[Answer<'_>], is_strict: bool) -> Result<()> {
    let have_rows = answers.iter().any(|answer| !answer.sources.is_empty());
    let lacking = answers.iter().filter(|answer| !answer.may_be_unanswered()).find_map(|answer| answer.lacks.as_ref());
    match lacking {
        Some(error) if is_strict || !have_rows => Err(error.clone().into()),
        _ => Ok(()),
    }
}
