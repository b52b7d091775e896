//! The answers that a folder's verdict files already hold: a run with fewer rows must not replace them.

use super::judge::Answer;
use super::listing::{CSV, FOLDER, MARKDOWN};
use super::verdict::Verdict;
use crate::error::{InputError, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// Refuses to write verdicts into a folder whose files answer claims that these leave open to another run.
pub fn check_no_loss(option: &str, answers: &[Answer<'_>], out: &Path) -> Result<()> {
    for (path, read) in [(out.join(FOLDER).join(CSV), in_table as fn(&Path) -> Kept), (out.join(MARKDOWN), in_text)] {
        let kept = read(&path);
        let is_lost =
            |answer: &&Answer<'_>| kept.get(&answer.claim.id).is_some_and(|kept| kept.says() > answer.verdict.says());
        let lost: Vec<String> = answers.iter().filter(is_lost).map(|answer| answer.claim.id.to_string()).collect();
        if !lost.is_empty() {
            let problem = format!("answers claims that these rows do not answer: {}", lost.join(", "));
            let error = InputError::new(option, path.display().to_string(), problem);
            return Err(error.allowed("another folder, or more folders of rows").into());
        }
    }
    Ok(())
}

/// The verdict on each claim.
type Kept = BTreeMap<u32, Verdict>;

/// The verdicts in a table; none if there is no such file.
fn in_table(path: &Path) -> Kept {
    let Ok(reader) = csv::Reader::from_path(path) else { return Kept::new() };
    let rows = reader.into_records().filter_map(std::result::Result::ok);
    rows.filter_map(|row| verdict(row.get(0)?, row.get(2)?)).collect()
}

/// The verdicts in a text; none if there is no such file.
fn in_text(path: &Path) -> Kept {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let entries = text.split("\n### ").skip(1);
    let of_entry = |entry: &str| {
        let (id, rest) = entry.split_once(". ")?;
        let (_, rest) = rest.split_once("\n\n**")?;
        verdict(id, &rest.split_once("**")?.0.to_lowercase().replace(' ', "-"))
    };
    entries.filter_map(of_entry).collect()
}

/// A claim's number with its verdict, if both can be read.
fn verdict(id: &str, name: &str) -> Option<(u32, Verdict)> {
    Some((id.parse().ok()?, Verdict::named(name)?))
}
