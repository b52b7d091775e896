//! Cells whose workers are processes: `mpiexec` starts several processes of this program, and the first prints the row.

use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::image_io::{self, Image};
use crate::measure::{Record, SETTINGS, Settings, Setup};
use serde_json::Value;
use std::env;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::Path;
use std::process::{Command, Stdio};

/// The program that starts processes, unless [`LAUNCHER_VARIABLE`] holds another command, such as
/// `mpiexec --oversubscribe`.
const LAUNCHER: &str = "mpiexec";
const LAUNCHER_VARIABLE: &str = "PATHMARK_MPIEXEC";

/// Renders with `ranks` processes. `Ok(None)` if there is no launcher.
pub(super) fn run_processes(
    settings: &Settings,
    ranks: u16,
    rule: &str,
    trace: Option<&Path>,
) -> Result<Option<(Record, Image)>> {
    let folder = tempfile::tempdir().map_err(|e| Error::system("making", "a temporary folder", e))?;
    let image = folder.path().join("image.pfm");
    let mut arguments = options(settings, rule);
    arguments.extend(["--image".into(), image.clone().into_os_string()]);
    if let Some(path) = trace {
        arguments.extend(["--trace".into(), path.as_os_str().to_owned()]);
    }
    let Some(printed) = printed_by_ranks(ranks, &arguments)? else { return Ok(None) };
    let record = record(&printed).ok_or_else(|| Error::Check(format!("{ranks} processes printed no record")))?;
    Ok(Some((record, image_io::read(&image)?)))
}

/// Runs `ranks` processes of this program; returns their standard output. `Ok(None)` if there is no launcher.
fn printed_by_ranks(ranks: u16, arguments: &[OsString]) -> Result<Option<Vec<u8>>> {
    let launcher = env::var(LAUNCHER_VARIABLE).unwrap_or_else(|_| LAUNCHER.to_string());
    let mut words = launcher.split_whitespace();
    let program = words.next().unwrap_or(LAUNCHER);
    let own = env::current_exe().map_err(|e| Error::system("finding", "this program", e))?;
    let mut command = Command::new(program);
    command.args(words).arg("-n").arg(ranks.to_string()).arg(own).args(arguments);
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
    let arguments = ["message-costs", "--json"].map(OsString::from);
    let Some(printed) = printed_by_ranks(2, &arguments)? else { return Ok(false) };
    atomic_file::write(path, |file| file.write_all(&printed))?;
    Ok(true)
}

/// The command-line arguments of a render with these settings.
fn options(settings: &Settings, rule: &str) -> Vec<OsString> {
    let mut options = vec!["render".to_string(), settings.scene.clone(), "--quiet".to_string(), "--json".to_string()];
    let samples_and_seed = ["spp", "seed", "clamp"];
    for axis in SETTINGS.iter().filter(|axis| !axis.about.is_empty() || samples_and_seed.contains(&axis.name)) {
        let value = axis.show(settings);
        if !value.is_empty() {
            options.extend([format!("--{}", axis.name), value]);
        }
    }
    options.extend(["--ranks".to_string(), rule.to_string()]);
    let cache = settings.cache.iter().flat_map(|folder| [OsString::from("--cache"), folder.clone().into_os_string()]);
    options.into_iter().map(OsString::from).chain(cache).collect()
}

/// The record that the first process printed; its merge time includes the time of gathering.
fn record(printed: &[u8]) -> Option<Record> {
    let mut value: Value = serde_json::from_slice(printed).ok()?;
    let fields = value.as_object_mut()?;
    fields.remove("by_rank")?;
    let gather_s = fields.remove("gather_s")?.as_f64()?;
    let record: Record = serde_json::from_value(value).ok()?;
    Some(Record { merge_s: record.merge_s.map(|merge_s| merge_s + gather_s), ..record })
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
