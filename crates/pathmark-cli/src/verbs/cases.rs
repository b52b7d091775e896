//! Hard cases: tries them as evidence for claims, for `selftest` and `reproduce`.

use crate::cases_file::{self, CaseRow};
use crate::check::{self, Case, Effort, Outcome, case_row};
use crate::error::Result;
use crate::experiment::Progress;
use crate::measure::available_threads;
use std::path::Path;

/// Tries cases on all processors.
pub(super) fn try_all(cases: &[&'static Case], effort: Effort, console: &dyn Progress) -> Result<Vec<Outcome>> {
    console.begin("hard cases", cases.len() as u64);
    let outcomes = check::run(cases, effort, available_threads(), &|done| console.advance(done))?;
    console.end();
    Ok(outcomes)
}

/// Writes the outcomes of some cases into a folder of results.
pub(super) fn write(out: &Path, cases: &[&'static Case], outcomes: &[Outcome]) -> Result<()> {
    let rows: Vec<CaseRow> = cases.iter().zip(outcomes).map(|(case, outcome)| case_row(case, outcome)).collect();
    cases_file::write(out, &rows)
}
