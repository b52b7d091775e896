//! Rows of `check/cases.csv`.

use crate::cases_file::CaseRow;
use crate::{Case, Outcome, Trial};

/// The row of a case. It shows the first trial that failed, or else the last.
pub fn case_row(case: &Case, outcome: &Outcome) -> CaseRow {
    let shown = outcome.failures().next().or(outcome.trials.last());
    let of = |part: fn(&Trial) -> String| shown.map(part).unwrap_or_default();
    CaseRow {
        id: case.id.to_string(),
        tries: case.tries.to_string(),
        pass: outcome.passed(),
        trials: outcome.trials.len(),
        failed: outcome.failures().count(),
        variant: of(|trial| trial.variant.clone()),
        expected: of(|trial| trial.expected.clone()),
        found: of(|trial| trial.found.clone()),
        skipped: outcome.skipped.join("; "),
    }
}
