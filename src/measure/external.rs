//! External programs: run by their command, timed from outside, with the image read from the file that they write.

use super::Settings;
use super::record::{Measured, Record, external_row};
use crate::error::{Error, InputError, Result};
use crate::image_io::{self, Image};
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// The result of an external program.
pub struct ExternalRun {
    /// Its image.
    pub image: Image,
    /// Seconds from its start to its end, start-up and writing included.
    pub wall_s: f64,
    /// CPU seconds in the program and in the system.
    pub cpu_s: Option<[f64; 2]>,
}

/// CPU seconds of all children so far.
fn children_s() -> Option<[f64; 2]> {
    let counted = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    Some([counted.user_time(), counted.system_time()].map(|time| time.num_microseconds() as f64 * 1e-6))
}

/// Exit codes of shells, and of `env`, for a program that is missing or cannot be run.
const NOT_THERE: [i32; 2] = [126, 127];

/// Runs a command that writes `out`. `Ok(None)` if there is no such program.
pub fn run_external(command: &[String], out: &Path) -> Result<Option<ExternalRun>> {
    let Some((program, arguments)) = command.split_first() else {
        return Err(InputError::new("command", "[]", "names no program").into());
    };
    let (before, start) = (children_s(), Instant::now());
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output();
    let wall_s = start.elapsed().as_secs_f64();
    let output = match output {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        other => other.map_err(|e| Error::system("running", program, e))?,
    };
    let code = output.status.code();
    if code.is_some_and(|code| NOT_THERE.contains(&code)) {
        return Ok(None);
    }
    if !output.status.success() {
        let said: String = String::from_utf8_lossy(&output.stderr).trim().chars().take(200).collect();
        let problem = format!("ended with {}: {said}", output.status);
        return Err(InputError::new("command", command.join(" "), problem).into());
    }
    let cpu_s = before.zip(children_s()).map(|(before, after)| [after[0] - before[0], after[1] - before[1]]);
    Ok(Some(ExternalRun { image: image_io::read(out)?, wall_s, cpu_s }))
}

impl ExternalRun {
    /// Its row: the measurements, for settings whose estimator is the program's name.
    pub fn record(&self, settings: &Settings, scene_hash: &str, errors: Measured) -> Record {
        Record {
            scene_hash: scene_hash.to_string(),
            makespan_s: Some(self.wall_s),
            cpu_user_s: self.cpu_s.map(|cpu| cpu[0]),
            cpu_system_s: self.cpu_s.map(|cpu| cpu[1]),
            mean_radiance: Some(self.image.mean().iter().sum::<f64>() / 3.0),
            paths: Some(u64::from(settings.spec.width) * u64::from(settings.spec.height) * u64::from(settings.spp)),
            ..external_row(settings, errors)
        }
    }
}

/// The row of a missing program: no failure, but without measurements.
pub fn missing_external(settings: &Settings, scene_hash: &str) -> Record {
    let mut record = external_row(settings, Measured::default());
    record.scene_hash = scene_hash.to_string();
    record.warn(&super::Warning::NoProgram);
    record
}
