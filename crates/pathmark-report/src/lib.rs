//! The report: turns records into figures, tables, findings and one self-contained page.

pub mod artifact;
pub mod bursts;
pub mod claims;
mod class;
mod contenders;
mod crops;
mod estimated;
#[cfg(test)]
mod figure_tests;
mod figures;
pub mod forecasts;
pub mod latex;
mod page;
#[cfg(test)]
mod pairing_tests;
mod paper;
pub mod plot;
mod prelude;
pub mod rank_forecasts;
mod remedy;
mod results;
mod rows;
mod serial;
#[cfg(test)]
mod tests;
mod time;
pub mod timeline;
mod titles;
#[cfg(test)]
mod trace_tests;
pub mod why;
pub mod words;

pub use crops::Crop;
pub use estimated::{Estimated, LEVEL};
pub use figures::{FIGURES, FigureEntry, check_figures, figure_of_serial};
pub use page::block::Block;
pub use page::replication;
pub use results::Results;
pub use words::counted;

use crate::error::{Error, InputError, Result};
use crate::experiment::{MACHINE, records_path};
use crate::files::{Files, create_folder};
use crate::lab::Lab;
use class::{Class, Member, members};
use page::{Section, block, doctor, guards, table};
use paper::Part;
use pathmark_harness::{
    analysis, atomic_file, cases_file, cluster, csv_file, digest, error, experiment, files, film_file, guard_prices,
    image_io, input, kernel, lab, measure, metric, scene, shell, simulate, strategy,
};
use rayon::prelude::*;
use rows::{naming, paired, schedule};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The page's name in a folder of results.
const PAGE: &str = "report.html";

/// The folder of pages of one section each.
const PAGES: &str = "pages";

/// The page of a class with more folders only links to their figures, so that it stays small.
const MOST_DRAWN: usize = 8;

/// Enters the page of a folder into the files of a command that will write it. `option` is the option that named the
/// folder. Refuses a folder that has another file of that name.
pub fn claim(option: &str, out: &Path, files: &mut Files) -> Result<()> {
    files.renews(option, &out.join(PAGE), page::is_page)
}

/// A page that was written.
pub struct Written {
    pub path: PathBuf,
    /// The folders of a class that are not on it, each with the reason.
    pub left_out: Vec<String>,
}

/// Draws the figures of every experiment in a folder, or in the folders of a class, and writes `report.html` there; returns
/// the page's path. The page shows the verdicts on claims; only the verb `claims` writes them into files.
pub fn write(lab: &Arc<Lab>, out: &Path) -> Result<PathBuf> {
    Ok(write_told(lab, out)?.path)
}

/// Like [`write()`], but also tells which folders of a class are not on the page.
pub fn write_told(lab: &Arc<Lab>, out: &Path) -> Result<Written> {
    let (sections, left_out) = sections(lab, out)?;
    Ok(Written { path: write_page(&sections, out)?, left_out })
}

/// Like [`write_told()`], but also writes a page for each experiment, and a list of them, into the folder `pages`; returns the
/// list's path. `option` is the option that asked for them. Refuses to replace other files.
pub fn write_pages(option: &str, lab: &Arc<Lab>, out: &Path) -> Result<Written> {
    let (mut sections, left_out) = sections(lab, out)?;
    let folder = out.join(PAGES);
    let index = folder.join(page::INDEX);
    let path = |section: &Section| folder.join(format!("{}.html", section.name));
    let mut files = Files::default();
    for path in sections.iter().map(path).chain([index.clone()]) {
        files.renews(option, &path, page::is_page)?;
    }
    write_page(&sections, out)?;
    create_folder(option, &folder)?;
    for section in &mut sections {
        // Paths are as seen from the page, which has room for figures.
        section.files.iter_mut().for_each(|file| *file = format!("../{file}"));
        section.linked_figures = None;
    }
    for section in &sections {
        let html = page::html_of_one(section)?;
        atomic_file::write(&path(section), |file| file.write_all(html.as_bytes()))?;
    }
    atomic_file::write(&index, |file| file.write_all(page::index(&sections).as_bytes()))?;
    Ok(Written { path: index, left_out })
}

fn write_page(sections: &[Section], out: &Path) -> Result<PathBuf> {
    let page = out.join(PAGE);
    let html = page::html(sections)?;
    atomic_file::write(&page, |file| file.write_all(html.as_bytes()))?;
    Ok(page)
}

/// The sections of a folder, whose figures are drawn, and the folders of a class that are left out.
fn sections(lab: &Arc<Lab>, out: &Path) -> Result<(Vec<Section>, Vec<String>)> {
    let (mut sections, mut class) = (Vec::<Section>::new(), Class::default());
    let add = |sections: &mut Vec<Section>, folder: &Path, section: Section| {
        // Compressing pictures takes most of the time.
        let save = |block: &Block| block.save(&folder.join("figures"));
        let saved: Vec<Result<()>> = section.blocks.par_iter().map(save).collect();
        saved.into_iter().collect::<Result<()>>()?;
        sections.push(section);
        Ok::<(), Error>(())
    };
    let members = members(out)?;
    let are_many = members.len() > MOST_DRAWN;
    let (mut left_out, mut first_error) = (class::without_rows(out, &members)?, None);
    for Member { folder, student } in members {
        let mut drawn = || {
            let results = Results::read(lab, folder.parent().unwrap_or(out), &folder)?;
            let blocks = figures::blocks(&results)?;
            if let Some(student) = &student {
                class.add(student, &results)?;
            }
            Ok::<_, Error>((results, blocks))
        };
        let (results, blocks) = match (drawn(), &student) {
            (Ok(drawn), _) => drawn,
            (Err(error), None) => return Err(error),
            // One student's damaged rows are no reason to show nobody's.
            (Err(error), Some(student)) => {
                left_out.push(format!("{student} is left out: {error}"));
                first_error = first_error.or(Some(error));
                continue;
            }
        };
        let own = folder.strip_prefix(out).unwrap_or(&folder);
        let seen = |file: &Path| own.join(file.file_name().unwrap_or_default()).display().to_string();
        let files = vec![seen(&records_path(&folder)), seen(Path::new(MACHINE))];
        let linked_figures = (student.is_some() && are_many).then(|| seen(Path::new("figures")));
        let section = Section { files, linked_figures, ..Section::of(results, blocks) };
        add(&mut sections, &folder, class::of_student(student.as_deref(), section))?;
    }
    if let Some(error) = first_error.filter(|_| class.is_empty()) {
        return Err(error);
    }
    if let Some(section) = class.section(out) {
        add(&mut sections, out, section)?;
    }
    if let Some(section) = sections.last_mut() {
        section.blocks.splice(0..0, left_out.iter().map(Block::notice));
    }
    for section in [guards::section(out)?, page::bursts::section(out)?].into_iter().flatten() {
        add(&mut sections, &out.join(&section.name), section)?;
    }
    if !sections.is_empty() {
        sections.extend(doctor::section(out)?);
    }
    sections.extend(replication::section(out)?);
    // The rows of students answer no claim of the reports.
    if class.is_empty() {
        sections.extend(claims::section(lab, out)?);
    }
    if sections.is_empty() {
        let problem = "holds no experiment: no folder in it has a records.csv";
        return Err(InputError::new("folder", out.display().to_string(), problem).into());
    }
    Ok((sections, left_out))
}

/// Writes `crops.png` beside the figures of each experiment of a folder that draws the figure `equal-time`; returns the
/// paths. Refuses a folder without such an experiment.
pub fn write_crops(lab: &Arc<Lab>, out: &Path, crops: &[Crop]) -> Result<Vec<PathBuf>> {
    let mut paths = Vec::new();
    for Member { folder, .. } in members(out)? {
        let results = Results::read(lab, folder.parent().unwrap_or(out), &folder)?;
        if !results.definition.figures.iter().any(|figure| figure == "equal-time") {
            continue;
        }
        if let Some(block) = crops::block(&results, crops)? {
            let figures = folder.join("figures");
            block.save(&figures)?;
            paths.push(figures.join(crops::STEM).with_extension("png"));
        }
    }
    if paths.is_empty() {
        let problem = "has no experiment whose pictures can be cropped";
        let error = InputError::new("folder", out.display().to_string(), problem);
        return Err(error.allowed("an experiment with the figure `equal-time` and keep = [\"images\"]").into());
    }
    Ok(paths)
}

/// Writes a draft of a paper on the experiments of a folder, whose figures have been drawn.
pub fn write_paper(lab: &Arc<Lab>, out: &Path, file: &Path) -> Result<()> {
    let mut parts = Vec::new();
    for Member { folder, .. } in members(out)? {
        let results = Results::read(lab, folder.parent().unwrap_or(out), &folder)?;
        let blocks = figures::blocks(&results)?;
        parts.push(Part { results, blocks });
    }
    let complete = |path: &Path| path.canonicalize().map_err(|e| Error::system("looking for", path, e));
    let beside = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let way = page::way(&complete(beside)?, &complete(out)?);
    let text = paper::text(&parts, &way.display().to_string().replace('\\', "/"));
    atomic_file::write(file, |file| file.write_all(text.as_bytes()))
}
