//! A sweep of two builds in turns: `run EXPERIMENT --baseline OLD`.
//!
//! Both builds run each cell in adjacent pairs ([`super::pairs`]), and alternate in going first; curves run whole, one build
//! after the other. Drift of the machine's speed affects both rows of a pair equally, so their ratio is free of it. The other build's rows lie in
//! `OUT/baseline`, like those of a separate sweep.

use super::cell_process::{CELL_ABOUT, CellJob, PointJob};
use super::process_group::answer;
use super::records_file::RecordsFile;
use super::run_file::{MACHINE, RunFile};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::measure::Record;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const FOLDER: &str = "baseline";

/// The time in which a program prints its help. A program of another kind may run for ever.
const HELP: Duration = Duration::from_mins(1);

pub(super) struct Baseline {
    program: PathBuf,
    folder: PathBuf,
    run: RunFile,
    file: RecordsFile,
    has_rows: bool,
}

pub fn baseline_folder(out: &Path, name: &str) -> PathBuf {
    out.join(FOLDER).join(name)
}

/// Refuses a file that is no program, and a program that cannot run cells, before any work starts. `field` is how the user
/// gave it.
pub(super) fn check_program(field: &str, program: &Path) -> Result<()> {
    let refused = |problem: &str| {
        let error = InputError::new(field, program.display().to_string(), problem);
        Err(error.allowed("another build of pathmark, or of a program with the same command line").into())
    };
    let is_program = fs::metadata(program).is_ok_and(|data| data.is_file() && data.permissions().mode() & 0o111 != 0);
    if !is_program {
        return refused("is not an executable program");
    }
    // An absolute path, because a name without a folder would be searched for elsewhere.
    let program = fs::canonicalize(program).map_err(|e| Error::system("finding", program, e))?;
    let mut help = Command::new(&program);
    help.args(["cell", "--help"]);
    match answer(help, "", Some(HELP)) {
        Ok(Some(help)) if String::from_utf8_lossy(&help.stdout).contains(CELL_ABOUT) => Ok(()),
        Ok(_) => refused("cannot run the cells of a sweep"),
        Err(error) => refused(&format!("cannot be started ({error})")),
    }
}

/// Name and version of a program, as it tells them; empty if it does not.
fn version_of(program: &Path) -> String {
    let mut version = Command::new(program);
    version.arg("--version");
    let told = answer(version, "", Some(HELP)).ok().flatten();
    let told = told.map(|told| String::from_utf8_lossy(&told.stdout).into_owned()).unwrap_or_default();
    told.lines().next().unwrap_or_default().trim().to_string()
}

impl Baseline {
    pub(super) fn open(program: &Path, out: &Path, name: &str, text: &str, run: RunFile) -> Result<Self> {
        let folder = baseline_folder(out, name);
        fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
        let file = RecordsFile::create(&folder.join("records.csv"))?;
        atomic_file::write(&folder.join("experiment.toml"), |out| out.write_all(text.as_bytes()))?;
        let program = fs::canonicalize(program).map_err(|e| Error::system("finding", program, e))?;
        Ok(Self { program, folder, run, file, has_rows: false })
    }

    /// The program that runs its cells.
    pub(super) fn program(&self) -> &Path {
        &self.program
    }

    /// Its job of a cell: images and traces are kept of this build only.
    pub(super) fn job(job: &CellJob) -> CellJob {
        let points = job.points.iter().map(|point| PointJob { image: None, ..point.clone() }).collect();
        CellJob { points, trace: None, ..job.clone() }
    }

    /// Runs a repetition of a cell; returns its rows.
    pub(super) fn run(&mut self, job: &CellJob, limit: Option<Duration>) -> Result<Vec<Record>> {
        let rows = Self::job(job).run_in_child(Some(self.program.as_path()), limit);
        let rows: Vec<Record> = rows.into_iter().map(|row| Record { run_order: job.order, ..row }).collect();
        self.append(&rows)?;
        Ok(rows)
    }

    /// Adds its rows to the file.
    pub(super) fn append(&mut self, rows: &[Record]) -> Result<()> {
        if let Some(first) = rows.first().filter(|_| !self.has_rows) {
            // The rows say which build measured them.
            self.run.program = version_of(&self.program);
            self.run.machine.commit.clone_from(&first.commit);
            self.run.machine.dirty = first.dirty;
            self.run.write(&self.folder.join(MACHINE))?;
            self.has_rows = true;
        }
        self.file.append_all(rows)
    }
}
