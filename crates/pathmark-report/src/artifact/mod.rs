//! Artifacts: an archive of rows, ledger, verdicts, page and instructions, from which others judge the claims and measure
//! the rows again.
//!
//! ```text
//! README.md                  the appendix that ACM and cTuning ask for
//! CITATION.cff, ro-crate-metadata.json, Containerfile
//! claims.csv, CLAIMS.md      the verdicts
//! first-claim.sh, measure-first-claim.sh
//! ledger/NAME.toml
//! rows/RUN/report.html
//! rows/RUN/EXPERIMENT/records.csv, machine.toml, experiment.toml
//! ```

mod again;
mod appendix;
mod citation;
mod metadata;
mod recipes;
mod runs;
mod yaml;

pub use citation::{CITATION, Citation};
pub use metadata::{Listed, listed};

use crate::claims::{Answer, Listing, Report, Verdict, judge, one_line};
use crate::csv_file;
use crate::error::{Error, InputError, Result};
use crate::experiment::Definition;
use crate::files::create_folder;
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{Machine, utc_now};
use crate::results::Results;
use crate::{PAGE, page};
use again::{Cost, costs, folder_of};
use appendix::{Appendix, Experiment};
use metadata::{METADATA, files_below, look_at};
use recipes::Program;
use runs::{Run, add_evidence, experiments_in, folders_in, plain, runs_of};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

const ROWS: &str = "rows";
const LEDGER: &str = "ledger";
const CLAIMS: &str = "claims.csv";
const VERDICTS: &str = "CLAIMS.md";
const README: &str = "README.md";
const CONTAINER: &str = "Containerfile";
/// The scripts that judge the first claim, and that measure its rows again.
const FIRST: &str = "first-claim.sh";
const MEASURE: &str = "measure-first-claim.sh";
/// The files that every artifact has.
const NEEDED: [&str; 6] = [README, CITATION, CONTAINER, CLAIMS, VERDICTS, FIRST];

/// An artifact to be made.
pub struct Request<'a> {
    /// Its folder: a new or an empty one.
    pub archive: &'a Path,
    /// Folders of results.
    pub folders: &'a [PathBuf],
    /// A ledger, or a folder of ledgers; `None` for the program's own.
    pub ledger: Option<&'a Path>,
    pub citation: &'a Citation,
}

/// An artifact that was made.
pub struct Written {
    pub files: usize,
    pub bytes: u64,
}

/// An artifact that passed its check.
pub struct Checked {
    pub files: usize,
    /// The rows in words.
    pub rows: String,
    /// A line for each verdict.
    pub verdicts: Vec<String>,
}

/// A line of `claims.csv`: a claim and its verdict.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stated {
    claim: u32,
    report: String,
    verdict: String,
    measured: String,
    predicted: String,
    rule: String,
    runs: String,
    rows: String,
    says: String,
}

impl Stated {
    fn of(answer: &Answer<'_>) -> Self {
        Self {
            claim: answer.claim.id,
            report: answer.report.report.clone(),
            verdict: answer.verdict.name().to_string(),
            measured: answer.measured(),
            predicted: answer.predicted(),
            rule: answer.rule(),
            runs: answer.in_runs(),
            rows: answer.source().unwrap_or_default(),
            // Each claim has one line.
            says: one_line(&answer.claim.claim),
        }
    }
}

/// Makes an artifact. All input is read before its folder is created; the list of its files is written last, so a folder
/// without it is not finished.
pub fn write(lab: &Arc<Lab>, request: &Request<'_>) -> Result<Written> {
    let Request { archive, folders, ledger, citation } = *request;
    check_new(archive)?;
    let (reports, texts) = match ledger {
        None => (Report::all(lab)?, Report::texts(lab).to_vec()),
        Some(path) => (Report::read(path)?, texts_of(path)?),
    };
    let mut runs = runs_of(folders)?;
    let experiments = read_experiments(lab, &runs)?;
    let of_sources = judge(lab, &reports, folders)?;
    first_of(&of_sources)?;
    add_evidence(lab, &mut runs, &of_sources)?;
    let date = today()?;

    create_folder("archive", archive)?;
    let writer = Writer { archive };
    for run in &runs {
        writer.run(lab, run)?;
    }
    for (name, text) in &texts {
        writer.put(&format!("{LEDGER}/{name}.toml"), text)?;
    }
    // As the check will read them: in the order of their files, and as somebody's own.
    let reports = Report::read(&archive.join(LEDGER))?;
    let copies: Vec<PathBuf> = runs.iter().map(|run| archive.join(ROWS).join(&run.name)).collect();
    let begun = Instant::now();
    let mut answers = judge(lab, &reports, &copies)?;
    let judge_s = begun.elapsed().as_secs_f64();
    check_complete(&of_sources, &answers)?;
    writer.put(VERDICTS, &verdicts(&reports, &answers, archive))?;
    shorten(&mut answers, archive);
    csv_file::write(&archive.join(CLAIMS), answers.iter().map(Stated::of))?;

    let costs = costs(lab, archive, &answers)?;
    let left_out = writer.scenes(costs.values().flatten())?;
    let (first, here, program) = (first_of(&answers)?, Machine::look(), Program::of(lab));
    let measure = program.measure(first);
    writer.put(FIRST, &program.first(first.claim.id))?;
    if let Some(script) = &measure {
        writer.put(MEASURE, script)?;
    }
    let commits = experiments.iter().map(|own| own.run.machine.commit.clone()).collect();
    let features = experiments.iter().flat_map(|own| own.features.clone()).collect();
    writer.put(CONTAINER, &program.container(&here, &commits, &features, measure.is_some()))?;
    writer.put(CITATION, &citation.to_cff(&date))?;
    let appendix = Appendix {
        citation,
        date: &date,
        program: &program,
        features: &features,
        here: &here,
        answers: &answers,
        tables: &appendix::tables(&answers),
        first,
        can_measure: measure.is_some(),
        costs: &costs,
        experiments: &experiments,
        left_out: &left_out,
        judge_s,
        bytes: listed_below(archive)?.iter().map(|file| file.bytes).sum(),
    };
    writer.put(README, &appendix.text())?;
    let files = listed_below(archive)?;
    writer.put(METADATA, &metadata::text(&files, citation, &appendix.summary(), &date, &program))?;
    Ok(Written { files: files.len() + 1, bytes: files.iter().map(|file| file.bytes).sum() })
}

/// Refuses an archive whose files give another verdict than the folders that it was made of.
fn check_complete(of_sources: &[Answer<'_>], answers: &[Answer<'_>]) -> Result<()> {
    let found: BTreeMap<u32, Verdict> = answers.iter().map(|answer| (answer.claim.id, answer.verdict)).collect();
    let is_other = |own: &&Answer<'_>| found.get(&own.claim.id) != Some(&own.verdict);
    let Some(own) = of_sources.iter().find(is_other) else { return Ok(()) };
    let told = found.get(&own.claim.id).map_or_else(|| "no verdict".to_string(), Verdict::to_string);
    let (id, verdict) = (own.claim.id, own.verdict);
    Err(Error::Check(format!("claim {id}: the folders give {verdict}, their files in the archive {told}")))
}

/// Refuses a folder that holds anything.
fn check_new(archive: &Path) -> Result<()> {
    match fs::read_dir(archive).map(|mut entries| entries.next().is_none()) {
        Ok(true) => Ok(()),
        Ok(false) => {
            let error = InputError::new("archive", archive.display().to_string(), "is not empty");
            Err(error.allowed("a new folder, or an empty one").into())
        }
        Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(()),
        Err(e) => Err(Error::system("reading", archive, e)),
    }
}

/// Names and texts of a user's ledgers.
fn texts_of(path: &Path) -> Result<Vec<(String, String)>> {
    let name = |file: &PathBuf| file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Report::files(path)?.iter().map(|file| Ok((name(file), read_text(file)?))).collect()
}

fn today() -> Result<String> {
    let no_date = || Error::system("reading", "the clock", io::Error::other("it shows no date"));
    utc_now().get(..10).map(str::to_string).ok_or_else(no_date)
}

/// Reads all rows that the archive will have.
fn read_experiments(lab: &Arc<Lab>, runs: &[Run]) -> Result<Vec<Experiment>> {
    let mut experiments = Vec::new();
    for run in runs {
        for folder in experiments_in(&run.folder)? {
            let Results { definition, run: measured, .. } = Results::read(lab, &run.folder, &folder)?;
            let Definition { title, requires, .. } = definition;
            let folder = Path::new(ROWS).join(&run.name).join(folder.file_name().unwrap_or_default());
            experiments.push(Experiment { folder, title, features: requires, run: measured });
        }
    }
    Ok(experiments)
}

/// The first claim that rows judge, if possible one whose rows can be measured again; or else the first that has rows.
fn first_of<'a, 'b>(answers: &'b [Answer<'a>]) -> Result<&'b Answer<'a>> {
    let is_judged =
        |answer: &Answer<'_>| matches!(answer.verdict, Verdict::Confirmed | Verdict::Refuted | Verdict::Open);
    let with_rows = answers.iter().filter(|answer| !answer.sources.is_empty());
    let first = with_rows.min_by_key(|answer| (!is_judged(answer), folder_of(answer).is_none()));
    first.ok_or_else(|| InputError::new("ledger", "", "has no claim that the rows of these folders answer").into())
}

/// The files of an archive without its list.
fn listed_below(archive: &Path) -> Result<Vec<Listed>> {
    files_below(archive)?.iter().map(|(name, path)| look_at(name, path)).collect()
}

/// Writes files of a new archive, and never replaces one.
struct Writer<'a> {
    archive: &'a Path,
}

impl Writer<'_> {
    fn create(&self, name: &str) -> Result<(File, PathBuf)> {
        let path = self.archive.join(name);
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(|e| Error::system("creating", folder, e))?;
        }
        let file = OpenOptions::new().write(true).create_new(true).open(&path);
        Ok((file.map_err(|e| Error::system("creating", &path, e))?, path))
    }

    fn put(&self, name: &str, text: &str) -> Result<()> {
        let (mut file, path) = self.create(name)?;
        io::Write::write_all(&mut file, text.as_bytes()).map_err(|e| Error::system("writing", path, e))
    }

    fn copy(&self, from: &Path, name: &str) -> Result<()> {
        let mut source = File::open(from).map_err(|e| Error::system("reading", from, e))?;
        let (mut file, path) = self.create(name)?;
        io::copy(&mut source, &mut file).map_err(|e| Error::system("writing", path, e))?;
        Ok(())
    }

    /// Copies the files of a run, and its page; a missing page is drawn.
    fn run(&self, lab: &Arc<Lab>, run: &Run) -> Result<()> {
        let folder = format!("{ROWS}/{}", run.name);
        for file in &run.files {
            let Some(name) = file.to_str() else {
                let error = InputError::new("file", file.display().to_string(), "has a name that is not UTF-8 text");
                return Err(error.into());
            };
            self.copy(&run.folder.join(file), &format!("{folder}/{name}"))?;
        }
        let page = run.folder.join(PAGE);
        if page::is_page(&page) {
            self.copy(&page, &format!("{folder}/{PAGE}"))?;
        } else if run.has_experiments {
            crate::write(lab, &self.archive.join(folder))?;
        }
        Ok(())
    }

    /// Copies the scene files of experiments, and returns those whose paths lead elsewhere.
    fn scenes<'a>(&self, costs: impl Iterator<Item = &'a Cost>) -> Result<BTreeSet<PathBuf>> {
        let mut left_out: BTreeSet<PathBuf> = costs.flat_map(|cost| cost.scenes.iter().cloned()).collect();
        for path in left_out.clone() {
            let own = plain(&path).and_then(|own| own.to_str().map(str::to_string));
            if let Some(own) = own.filter(|own| !self.archive.join(own).exists()) {
                self.copy(&path, &own)?;
                left_out.remove(&path);
            }
        }
        Ok(left_out)
    }
}

/// The text of the verdicts. Before the sources are shortened, because its links lead to them.
fn verdicts(reports: &[Report], answers: &[Answer<'_>], archive: &Path) -> String {
    Listing::of_artifact(reports).markdown_of(answers, archive)
}

/// Replaces the sources of answers by their paths in the archive.
fn shorten(answers: &mut [Answer<'_>], archive: &Path) {
    for source in answers.iter_mut().flat_map(|answer| &mut answer.sources) {
        *source = source.strip_prefix(archive).map_or_else(|_| source.clone(), Path::to_path_buf);
    }
}

/// Checks an archive from elsewhere: its list of files, their checksums, its citation and all rows, and whether these give
/// the stated verdicts. `claim` selects the verdict that is told; `None` tells all.
pub fn check(lab: &Arc<Lab>, archive: &Path, claim: Option<u32>) -> Result<Checked> {
    let rows = archive.join(ROWS);
    if !archive.is_dir() {
        return Err(InputError::new("archive", archive.display().to_string(), "there is no such folder").into());
    }
    let files = metadata::check(archive, &NEEDED)?;
    Citation::read(&archive.join(CITATION))?;
    if !rows.is_dir() {
        return Err(InputError::new("archive", rows.display().to_string(), "there is no such folder").into());
    }
    let (folders, mut experiments) = (folders_in(&rows)?, 0);
    for run in &folders {
        for folder in experiments_in(run)? {
            Results::read(lab, run, &folder)?;
            experiments += 1;
        }
    }
    let reports = Report::read(&archive.join(LEDGER))?;
    reports.iter().try_for_each(Report::check_paths)?;
    let mut answers = judge(lab, &reports, &folders)?;
    let text = verdicts(&reports, &answers, archive);
    shorten(&mut answers, archive);
    check_stated(lab, archive, &answers)?;
    check_text(lab, &archive.join(VERDICTS), &text)?;
    let ids = || answers.iter().map(|answer| answer.claim.id);
    if let Some(id) = claim.filter(|id| !ids().any(|own| own == *id)) {
        let known = ids().map(|id| id.to_string()).collect::<Vec<String>>().join(", ");
        let error = InputError::new("claim", id.to_string(), "is not in the ledger of the archive");
        return Err(error.allowed(known).into());
    }
    let told = answers.iter().filter(|answer| claim.is_none_or(|id| id == answer.claim.id));
    let rows = appendix::rows_in_words(experiments, appendix::tables(&answers).len());
    Ok(Checked { files, rows, verdicts: told.map(line).collect() })
}

fn line(answer: &Answer<'_>) -> String {
    let (id, verdict) = (answer.claim.id, answer.verdict);
    let numbers = if answer.sources.is_empty() {
        String::new()
    } else {
        format!("; measured {}, predicted {}", answer.measured(), answer.predicted())
    };
    format!("claim {id}: {verdict}, as stated{numbers}: {}", answer.claim.claim)
}

/// Compares the stated verdicts with those that the rows give.
fn check_stated(lab: &Lab, archive: &Path, answers: &[Answer<'_>]) -> Result<()> {
    let path = archive.join(CLAIMS);
    let wrong = |field: &str, value: String, problem: String, line: Option<usize>| {
        let at = line.map(|line| (line, 1));
        Err(Error::from(InputError::new(field, value, problem).in_file(path.display().to_string(), at)))
    };
    let mut stated = BTreeMap::new();
    for (index, row) in csv_file::read::<Stated>(&path)?.into_iter().enumerate() {
        let id = row.claim;
        if stated.insert(id, (index + 2, row)).is_some() {
            return wrong("claim", id.to_string(), "occurs twice".to_string(), Some(index + 2));
        }
    }
    let program = lab.program().join(" ");
    for answer in answers {
        let (id, found) = (answer.claim.id, Stated::of(answer));
        let Some((line, row)) = stated.remove(&id) else {
            return wrong("claim", id.to_string(), "is in the ledger, and has no line here".to_string(), None);
        };
        let pairs = [
            ("report", row.report, found.report),
            ("verdict", row.verdict, found.verdict),
            ("measured", row.measured, found.measured),
            ("predicted", row.predicted, found.predicted),
            ("rule", row.rule, found.rule),
            ("runs", row.runs, found.runs),
            ("rows", row.rows, found.rows),
            ("says", row.says, found.says),
        ];
        if let Some((field, stated, found)) = pairs.into_iter().find(|(_, stated, found)| stated != found) {
            let problem = format!("claim {id}: the rows give {found}, as {program} computes it");
            return wrong(field, stated, problem, Some(line));
        }
    }
    match stated.into_values().next() {
        None => Ok(()),
        Some((line, row)) => wrong("claim", row.claim.to_string(), "is not in the ledger".to_string(), Some(line)),
    }
}

/// Compares the text of the verdicts with the one that ledger and rows give.
fn check_text(lab: &Lab, path: &Path, expected: &str) -> Result<()> {
    let stated = read_text(path)?;
    if stated == expected {
        return Ok(());
    }
    let same = stated.lines().zip(expected.lines()).take_while(|(stated, expected)| stated == expected).count();
    let [stated, expected] = [stated.as_str(), expected].map(|text| text.lines().nth(same).unwrap_or_default());
    let problem = format!("{} writes: {expected}", lab.program().join(" "));
    Err(InputError::new("line", stated, problem).in_file(path.display().to_string(), Some((same + 1, 1))).into())
}
