//! Cells whose workers are processes: `mpiexec` starts several processes of this program, and the first prints the row.

use super::CellJob;
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::measure::{Record, Settings, Setup};
use std::env;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

/// The program that starts processes, unless [`LAUNCHER_VARIABLE`] holds another command, such as
/// `mpiexec.mpich`.
const LAUNCHER: &str = "mpiexec";
const LAUNCHER_VARIABLE: &str = "PATHMARK_MPIEXEC";
/// Variables with which Open MPI 4 and 5 start more processes than there are processors: an experiment may ask for that, and
/// the row then warns. Other libraries ignore them.
const OVERSUBSCRIBE: [(&str, &str); 2] =
    [("OMPI_MCA_rmaps_base_oversubscribe", "1"), ("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe")];

/// Runs a cell's job with `ranks` processes. They read it from a file, because a launcher gives its standard input to one
/// of them. `Ok(None)` if there is no launcher.
pub(super) fn run_processes(job: &CellJob, ranks: u16) -> Result<Option<Vec<Record>>> {
    let folder = tempfile::tempdir().map_err(|e| Error::system("making", "a temporary folder", e))?;
    let path = folder.path().join("cell.json");
    let text = serde_json::to_string(job).map_err(|e| Error::system("writing", &path, e.into()))?;
    std::fs::write(&path, text).map_err(|e| Error::system("writing", &path, e))?;
    let Some(printed) = printed_by_ranks(ranks, &["cell".into(), path.into_os_string()])? else { return Ok(None) };
    let rows = serde_json::from_slice(&printed);
    rows.map(Some).map_err(|e| Error::Check(format!("{ranks} processes printed no rows: {e}")))
}

/// Runs `ranks` processes of this program; returns their standard output. `Ok(None)` if there is no launcher.
fn printed_by_ranks(ranks: u16, arguments: &[OsString]) -> Result<Option<Vec<u8>>> {
    let launcher = env::var(LAUNCHER_VARIABLE).unwrap_or_else(|_| LAUNCHER.to_string());
    let mut words = launcher.split_whitespace();
    let program = words.next().unwrap_or(LAUNCHER);
    let own = env::current_exe().map_err(|e| Error::system("finding", "this program", e))?;
    let mut command = Command::new(program);
    command.args(words).arg("-n").arg(ranks.to_string()).arg(own).args(arguments);
    command.envs(OVERSUBSCRIBE.into_iter().filter(|(name, _)| env::var_os(name).is_none()));
    let output = match command.stdin(Stdio::null()).output() {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        other => other.map_err(|e| Error::system("running", program, e))?,
    };
    if !output.status.success() {
        let said: String = String::from_utf8_lossy(&output.stderr).trim().chars().take(400).collect();
        return Err(Error::Check(format!("{command:?} ended with {}: {said}", output.status)));
    }
    Ok(Some(output.stdout))
}

/// The file with the costs of messages between two processes, beside the rows of a sweep.
pub const MESSAGES: &str = "messages.json";

/// Times messages between two processes and writes the file; `Ok(false)` if there is no launcher.
pub(super) fn write_messages(path: &Path) -> Result<bool> {
    let arguments = ["inspect", "messages", "--json"].map(OsString::from);
    let Some(printed) = printed_by_ranks(2, &arguments)? else { return Ok(false) };
    atomic_file::write(path, |file| file.write_all(&printed))?;
    Ok(true)
}

/// Refuses settings with which processes cannot start, share jobs or give their output.
pub(super) fn check_processes(setup: &Setup) -> Result<()> {
    let settings = setup.settings();
    let (ranks, rule) = match (settings.ranks, setup.rank_rule()) {
        (None, None) => return Ok(()),
        (Some(ranks), Some(rule)) => (ranks, rule),
        (Some(ranks), None) => {
            let error = InputError::new("ranks", ranks.to_string(), "needs a rule by which the processes share jobs");
            return Err(error.allowed("ranks together with rank-rule").into());
        }
        (None, Some(rule)) => {
            let problem = "shares jobs among processes, but there are none";
            let error = InputError::new("rank-rule", rule.to_string(), problem);
            return Err(error.allowed("rank-rule together with ranks").into());
        }
    };
    if ranks == 0 {
        return Err(InputError::new("ranks", "0", "is out of range").allowed("1 or more").into());
    }
    rule.check(ranks.into())?;
    if settings.output == Settings::default().output {
        return Ok(());
    }
    let problem = "does not work with several processes, which send their pieces to rank 0";
    Err(InputError::new("output", &settings.output, problem).allowed(Settings::default().output).into())
}
