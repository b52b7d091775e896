//! The claims of the four reports, or of a ledger of one's own, each with a verdict that is computed from the results in a folder.
//!
//! A claim names the rows that answer it, a statistic, and the values that the report predicts for it (see `definition.rs`). To add one, add
//! it to `experiments/claims/REPORT.toml`.

mod absent;
mod agreement;
mod condition;
mod definition;
mod escape;
mod judge;
#[cfg(test)]
mod ledger_tests;
mod listing;
mod measure;
mod measurement;
mod places;
mod plain_rows;
#[cfg(test)]
mod plain_rows_tests;
mod statistic;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod unit_tests;
mod verdict;

pub use absent::check_files;
pub use agreement::Agreement;
pub use definition::{Claim, Needs, Report};
pub use judge::{Answer, judge};
pub use listing::{FOLDER, Listing, MARKDOWN, is_markdown, totals};
pub use plain_rows::PlainRows;
pub use verdict::Verdict;

pub(crate) use escape::one_line;

use super::page::Section;
use crate::error::Result;
use crate::lab::Lab;
use std::path::Path;
use std::sync::Arc;

const QUESTION: &str = "What was claimed, and what do the rows of this folder say about it?";

const ANALYSIS: &str = "Each claim names the rows that answer it, a statistic, and the values that the report predicts for that statistic. A claim is confirmed if the whole interval of \
the measurement lies within the prediction, refuted if it lies wholly outside, and open otherwise, also if runs differ. It is not comparable if the rows were measured under other conditions than the report's, \
and not answered if there are no rows.";

/// The verdicts as the first section of the page, if the folder has rows for any of them.
pub(super) fn section(lab: &Arc<Lab>, out: &Path) -> Result<Option<Section>> {
    let reports = Report::all(lab)?;
    let answers = judge(lab, &reports, &[out.to_path_buf()])?;
    let answered = answers.iter().filter(|answer| !answer.sources.is_empty()).count();
    if answered == 0 {
        return Ok(None);
    }
    Ok(Some(Section {
        name: FOLDER.to_string(),
        title: "What the reports said".to_string(),
        question: QUESTION.to_string(),
        analysis: ANALYSIS.to_string(),
        in_short: Some(listing::in_short(&answers)),
        rows: answered,
        blocks: listing::blocks(&answers),
        ..Section::default()
    }))
}
