//! The condition of the machine: `doctor.json`, which `reproduce` writes.

use crate::block::Block;
use crate::error::Result;
use crate::experiment::{Chapter, DOCTOR, Examination};
use crate::page::Section;
use crate::words::capital;
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
        |noise| Block::finding(capital(&format!("{}.", noise.finding()))),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_examination_is_a_section() {
        let folder = tempfile::tempdir().unwrap();
        assert!(section(folder.path()).unwrap().is_none());
        let plan = r#"{"processes":9,"pairs":40,"half_width":0.013,"seconds":590.0}"#;
        let noise = format!(
            r#"{{"processes":3,"pairs":30,"pair_s":0.05,"ratio":1.0,"low":0.9,"high":1.1,"in_ten_minutes":{plan}}}"#
        );
        let facts =
            r#"[{"name":"governor","value":"powersave","advice":"choose another"},{"name":"quota","value":"none"}]"#;
        let write = |noise: &str| {
            let text = format!(r#"{{"started_utc":"","facts":{facts},"noise":{noise}}}"#);
            std::fs::write(folder.path().join(DOCTOR), text).unwrap();
            section(folder.path()).unwrap().unwrap().blocks
        };
        let blocks = write(&noise);
        let finding = blocks[0].as_finding().unwrap();
        assert!(finding.starts_with("Differences below 1.30 % cannot be seen in 10 minutes here"), "{finding}");
        assert!(matches!(&blocks[1], Block::Table { table, .. } if table.len() == 2));
        assert!(write("null")[0].as_finding().is_none());
        std::fs::write(folder.path().join(DOCTOR), "[]").unwrap();
        assert_eq!(section(folder.path()).err().unwrap().exit_code(), 2);
    }
}
