//! Instruction counts of each cell's whole process, by valgrind's callgrind: `run EXPERIMENT --count-instructions`.
//!
//! Even on a busy machine, a count repeats to some millionths; a time does not repeat to some hundredths. Counts ignore
//! caches and waiting. Valgrind runs threads one at a time and has no AVX-512, so kernels in lanes use AVX2. The counts
//! of a sweep lie beside its rows in `instructions.csv`, which `diff --counts` compares.

use super::cell_process::CellJob;
use super::time_limit::{Limits, timed_out};
use super::{Cell, Progress, Sweep, baseline_folder, process_group};
use crate::csv_file;
use crate::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

pub(super) const INSTRUCTIONS: &str = "instructions.csv";
const COUNTER: &str = "valgrind";

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    cell: String,
    instructions: u64,
}

/// Refuses to begin if valgrind cannot be started.
pub(super) fn check_counter() -> Result<()> {
    let found = Command::new(COUNTER).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    found.map(drop).map_err(|e| Error::system("starting", COUNTER, e))
}

impl Sweep<'_> {
    /// Counts the instructions of each cell that runs in one process of this program, and the other build's if there is
    /// one.
    pub(super) fn count_instructions(&self, folder: &Path, progress: &dyn Progress) -> Result<()> {
        let own = env::current_exe().map_err(|e| Error::system("finding", "this program", e))?;
        let other = self.options.baseline.clone();
        let baseline = other.map(|program| (program, baseline_folder(&self.options.out, &self.definition.name)));
        let builds = [Some((own, folder.to_path_buf())), baseline];
        let of_this_program = |cell: &&Cell| cell.external.is_none() && cell.settings.ranks.is_none();
        let cells: Vec<&Cell> = self.cells.iter().filter(of_this_program).collect();
        for (program, folder) in builds.into_iter().flatten() {
            progress.begin(&format!("{}, instructions", self.definition.name), cells.len() as u64);
            let (mut counts, limits) = (BTreeMap::new(), Limits::of(self)?);
            for (done, cell) in (1..).zip(&cells) {
                let job = self.job(cell, (0, 0), &folder, &[], None);
                match count(&job, &program, limits.limit_of_counting(cell)) {
                    Ok(count) => _ = counts.insert(cell.id.clone(), count),
                    Err(error) => progress.note(&format!("{}: {error}", cell.id)),
                }
                progress.advance(done);
            }
            progress.end();
            write(&folder.join(INSTRUCTIONS), counts)?;
        }
        Ok(())
    }
}

/// Counts the instructions of a cell that `program` runs. `Err` says why there is no count.
fn count(job: &CellJob, program: &Path, limit: Option<Duration>) -> std::result::Result<u64, String> {
    // The process only renders the image: it reads, writes and compares nothing else.
    let text = serde_json::to_string(&job.alone()).map_err(|e| format!("describing the cell: {e}"))?;
    let mut command = Command::new(COUNTER);
    command.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(program).arg("cell");
    let output = process_group::answer(command, &text, limit)
        .map_err(|e| format!("running {COUNTER}: {e}"))?
        .ok_or_else(|| timed_out(limit))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("{COUNTER} ended with {}: {}", output.status, said.trim()));
    }
    collected(&said).ok_or_else(|| format!("{COUNTER} reported no count"))
}

/// The total in callgrind's last lines: `==7== Collected : 1234`.
fn collected(said: &str) -> Option<u64> {
    said.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok())
}

fn write(path: &Path, counts: BTreeMap<String, u64>) -> Result<()> {
    csv_file::write(path, counts.into_iter().map(|(cell, instructions)| Row { cell, instructions }))
}

/// Reads the counts beside a file of rows; empty if nothing was counted.
pub(super) fn read(rows: &Path) -> Result<BTreeMap<String, u64>> {
    let path: PathBuf = rows.with_file_name(INSTRUCTIONS);
    if !path.is_file() {
        return Ok(BTreeMap::new());
    }
    let rows = csv_file::read::<Row>(&path)?.into_iter();
    Ok(rows.map(|row| (row.cell, row.instructions)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_found_in_the_counters_output() {
        let said = "==12== Callgrind\n==12== Events    : Ir\n==12== Collected : 1066254367\n==12== \n==12== I   refs:      1,066,254,367\n";
        assert_eq!(collected(said), Some(1_066_254_367));
        assert_eq!((collected("==12== Collected : "), collected("")), (None, None));
    }

    #[test]
    fn written_rows_are_read_and_a_bad_row_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let rows = folder.path().join("records.csv");
        assert!(read(&rows).unwrap().is_empty());
        let counts = BTreeMap::from([("a,b".to_string(), 7), ("c".to_string(), u64::MAX)]);
        let path = folder.path().join(INSTRUCTIONS);
        write(&path, counts.clone()).unwrap();
        assert_eq!(read(&rows).unwrap(), counts);
        std::fs::write(&path, "cell,instructions\na,1\nb,-1\n").unwrap();
        let error = read(&rows).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains("instructions.csv:3"), "{error}");
    }
}
