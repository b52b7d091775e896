//! External programs: run by their command, timed from outside, with the image read from the file that they write.

use super::Settings;
use super::record::{Record, external_row};
use crate::error::{Error, InputError, Result};
use crate::image_io::{self, Image};
use crate::scene::Scene;
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

pub struct ExternalRun {
    pub image: Image,
    /// Seconds from its start to its end, start-up and writing included.
    pub wall_s: f64,
    /// Seconds of rendering as the program tells them: the last line of its output that begins with `seconds =`.
    pub told_s: Option<f64>,
    pub cpu_s: Option<[f64; 2]>,
}

/// The beginning of the line by which a program tells the seconds of its rendering.
const SECONDS: &str = "seconds =";

/// The seconds that a program tells; refuses what is no time within its run.
fn told_seconds(said: &[u8], wall_s: f64) -> std::result::Result<Option<f64>, String> {
    let said = String::from_utf8_lossy(said);
    let Some(value) = said.lines().rev().find_map(|line| line.trim().strip_prefix(SECONDS)) else { return Ok(None) };
    let seconds = value.trim().parse().ok().filter(|seconds| *seconds > 0.0 && *seconds <= wall_s);
    let value: String = value.trim().chars().take(40).collect();
    seconds.map(Some).ok_or_else(|| format!("tells `{SECONDS} {value}`, which is no time within its {wall_s:.3} s"))
}

fn children_s() -> Option<[f64; 2]> {
    let counted = getrusage(UsageWho::RUSAGE_CHILDREN).ok()?;
    Some([counted.user_time(), counted.system_time()].map(|time| time.num_microseconds() as f64 * 1e-6))
}

/// Exit codes of shells, and of `env`, for a program that is missing or cannot be run.
const NOT_THERE: [i32; 2] = [126, 127];

/// The last line that a program wrote: of a traceback, the one that says what is wrong.
fn last_line(said: &[u8]) -> String {
    let said = String::from_utf8_lossy(said);
    said.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or("").chars().take(200).collect()
}

/// Runs the command of the program `name`, which writes `out`. `Ok(None)` if there is no such program. Errors name the
/// program alone: its arguments differ from row to row.
pub fn run_external(name: &str, command: &[String], out: &Path) -> Result<Option<ExternalRun>> {
    let failed = |problem: String| InputError::new("external", name, problem);
    let Some((program, arguments)) = command.split_first() else {
        return Err(failed("has an empty command".to_string()).into());
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
        let said = last_line(&output.stderr);
        let said = if said.is_empty() { said } else { format!(": {said}") };
        return Err(failed(format!("ended with {}{said}", output.status)).into());
    }
    if !out.exists() {
        return Err(failed("wrote no image".to_string()).into());
    }
    let image = image_io::read(out).map_err(|error| match error {
        Error::Input(error) => failed(format!("wrote an image that cannot be read: {}", error.problem)).into(),
        other => other,
    })?;
    let told_s = told_seconds(&output.stdout, wall_s).map_err(failed)?;
    let cpu_s = before.zip(children_s()).map(|(before, after)| [after[0] - before[0], after[1] - before[1]]);
    Ok(Some(ExternalRun { image, wall_s, told_s, cpu_s }))
}

impl ExternalRun {
    /// Its row: the measurements, for settings whose estimator is the program's name. If the program tells its seconds of
    /// rendering, the rest of its run is the time to build its kernel.
    pub fn record(&self, settings: &Settings, scene: &Scene) -> Record {
        Record {
            makespan_s: Some(self.told_s.unwrap_or(self.wall_s)),
            kernel_build_s: self.told_s.map(|told| self.wall_s - told),
            cpu_user_s: self.cpu_s.map(|cpu| cpu[0]),
            cpu_system_s: self.cpu_s.map(|cpu| cpu[1]),
            mean_radiance: Some(self.image.mean().iter().sum::<f64>() / 3.0),
            samples: Some(u64::from(settings.spec.width) * u64::from(settings.spec.height) * u64::from(settings.spp)),
            ..external_row(settings, scene)
        }
    }
}

/// The row of a missing program: no failure, but without measurements.
pub fn missing_external(settings: &Settings, scene: &Scene) -> Record {
    let mut record = external_row(settings, scene);
    record.warn(&super::Warning::NoProgram);
    record
}
