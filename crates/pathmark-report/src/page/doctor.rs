//! The condition of the machine: `doctor.json`, which `reproduce` writes.

use crate::block::Block;
use crate::error::Result;
use crate::experiment::{Chapter, DOCTOR, Examination};
use crate::page::Section;
use std::path::Path;

const QUESTION: &str = "What disturbs measurements on this machine, and which differences can be seen on it?";

const ANALYSIS: &str = "Before the experiments, several processes timed pairs of equal runs. \
The spread of their ratios is the noise of a comparison: within a process by other programs and the clock, between processes by the layout of memory. `pathmark doctor` measures longer.";

/// The section, if a folder has an examination.
pub(crate) fn section(out: &Path) -> Result<Option<Section>> {
    let path = out.join(DOCTOR);
    if !path.is_file() {
        return Ok(None);
    }
    let Examination { facts, noise, .. } = Examination::read(&path)?;
    let noise = noise.map_or_else(
        || Block::notice("The pairs of equal runs gave no interval."),
        |noise| Block::finding(format!("{}.", noise.finding())),
    );
    let table = Block::table("condition", "The machine before the experiments", &facts)
        .column("fact", |fact| fact.name.clone())
        .column("value", |fact| fact.value.clone())
        .column("advice", |fact| fact.advice.clone())
        .end();
    Ok(Some(Section {
        name: "doctor".to_string(),
        title: "The machine's noise".to_string(),
        question: QUESTION.to_string(),
        analysis: ANALYSIS.to_string(),
        chapter: Some(Chapter::Scheduling),
        blocks: vec![noise, table],
        ..Section::default()
    }))
}
