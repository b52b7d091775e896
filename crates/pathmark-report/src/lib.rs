//! The report: turns records into figures, tables, findings and one self-contained page.

pub mod bursts;
pub mod claims;
mod contenders;
mod estimated;
#[cfg(test)]
mod figure_tests;
mod figures;
pub mod forecasts;
mod page;
#[cfg(test)]
mod pairing_tests;
pub mod plot;
mod prelude;
pub mod rank_forecasts;
mod remedy;
mod results;
mod rows;
mod serial;
#[cfg(test)]
mod tests;
pub mod timeline;
mod titles;
#[cfg(test)]
mod trace_tests;
pub mod why;
mod words;

pub use estimated::{Estimated, LEVEL};
pub use figures::{FIGURES, FigureEntry, check_figures, figure_of_serial};
pub use page::benches::{BenchRow, write_benches};
pub use page::block::Block;
pub use results::Results;
pub use words::counted;

use crate::error::{Error, InputError, Result};
use crate::experiment::MACHINE;
use crate::files::Files;
use crate::lab::Lab;
use page::{Section, benches, block, doctor, guards, table};
use pathmark_harness::{
    analysis, atomic_file, cases_file, cluster, csv_file, digest, error, experiment, files, film_file, guard_prices,
    image_io, input, kernel, lab, measure, metric, scene, shell, simulate, strategy,
};
use rows::{naming, paired, schedule};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The page's name in a folder of results.
const PAGE: &str = "report.html";

/// Enters the page of a folder into the files of a command that will write it. `option` is the option that named the
/// folder. Refuses a folder that has another file of that name.
pub fn claim(option: &str, out: &Path, files: &mut Files) -> Result<()> {
    files.renews(option, &out.join(PAGE), page::is_page)
}

/// Draws the figures of every experiment in a folder and writes `report.html` there; returns the page's path. The page
/// shows the verdicts on claims; only the verb `claims` writes them into files.
pub fn write(lab: &Arc<Lab>, out: &Path) -> Result<PathBuf> {
    let mut sections = Vec::new();
    let mut add = |folder: &Path, section: Section| {
        section.blocks.iter().try_for_each(|block| block.save(&folder.join("figures")))?;
        sections.push(section);
        Ok::<(), Error>(())
    };
    for folder in experiment_folders(out)? {
        let results = Results::read(lab, out, &folder)?;
        let blocks = figures::blocks(&results)?;
        let own = folder.file_name().unwrap_or_default().to_string_lossy();
        let files = ["records.csv", MACHINE].map(|file| format!("{own}/{file}")).to_vec();
        add(&folder, Section { files, ..Section::of(results, blocks) })?;
    }
    for section in [guards::section(out)?, page::bursts::section(out)?, benches::section(out)?].into_iter().flatten() {
        add(&out.join(&section.name), section)?;
    }
    if !sections.is_empty() {
        sections.extend(doctor::section(out)?);
    }
    sections.extend(claims::section(lab, out)?);
    if sections.is_empty() {
        let problem = "holds no experiment: no folder in it has a records.csv";
        return Err(InputError::new("folder", out.display().to_string(), problem).into());
    }
    let page = out.join(PAGE);
    let html = page::html(&sections)?;
    atomic_file::write(&page, |file| file.write_all(html.as_bytes()))?;
    Ok(page)
}

/// The folders that have records, sorted by name.
fn experiment_folders(out: &Path) -> Result<Vec<PathBuf>> {
    let entries = std::fs::read_dir(out).map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory => {
            InputError::new("folder", out.display().to_string(), "there is no such folder").into()
        }
        _ => Error::system("reading", out, e),
    })?;
    let mut folders = Vec::new();
    for entry in entries {
        let path = entry.map_err(|e| Error::system("reading", out, e))?.path();
        if path.join("records.csv").is_file() {
            folders.push(path);
        }
    }
    folders.sort();
    Ok(folders)
}
