//! Time limits of cells: `timeout = "10min"` in an experiment or in one of its profiles, `--timeout` on the command line.
//!
//! A limit applies to a process of a cell: one repetition, with all points of a curve and all ranks. At its limit, the
//! process and all processes that it started are killed, its rows have failed, and the sweep goes on.
//!
//! Without a limit of the user, a cell may take a millisecond per sample, and at least a minute. That is some hundred
//! times what samples take on one thread: a cell in which one worker does everything is slow, but not hung.

use super::{Cell, Sweep};
use crate::error::{InputError, Result};
use crate::lab::Lab;
use crate::measure::{Settings, available_threads};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer};
use std::time::Duration;

/// The beginning of the error of a row whose cell has reached its limit.
pub const TIMED_OUT: &str = "timed-out";

/// Fewest seconds of a limit that the user has not set.
const LEAST: Duration = Duration::from_mins(1);
/// The limit of another program and of a workload, whose samples may take any time.
const OF_OTHERS: Duration = Duration::from_hours(1);
/// Hardly any scene's sample takes longer.
const OF_SAMPLE: Duration = Duration::from_millis(1);
/// How much longer a process takes under valgrind, which also runs its threads one at a time.
const COUNTING: u32 = 50;

/// A time limit as the user gave it; `None` for no limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timeout(Option<Duration>);

const ALLOWED: &str = "a duration above 0 with its unit, such as 90s or 10min, or none";

impl Timeout {
    pub fn parse(text: &str) -> Result<Self> {
        let refused = || InputError::new("timeout", text, "is not a time limit").allowed(ALLOWED).into();
        Self::of_text(text).ok_or_else(refused)
    }

    fn of_text(text: &str) -> Option<Self> {
        if text == "none" {
            return Some(Self(None));
        }
        let length = humantime::parse_duration(text).ok().filter(|length| !length.is_zero())?;
        Some(Self(Some(length)))
    }
}

impl<'de> Deserialize<'de> for Timeout {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::of_text(&text).ok_or_else(|| D::Error::custom(format_args!("is not a time limit (allowed: {ALLOWED})")))
    }
}

pub(super) fn timed_out(limit: Option<Duration>) -> String {
    let limit = limit.map(|limit| format!(" of {}", humantime::format_duration(limit))).unwrap_or_default();
    format!("{TIMED_OUT}: the cell was ended at its time limit{limit}; `timeout` or --timeout sets another")
}

pub(super) struct Limits<'a> {
    lab: &'a Lab,
    set: Option<Timeout>,
}

impl<'a> Limits<'a> {
    pub(super) fn of(sweep: &Sweep<'a>) -> Result<Self> {
        let own = sweep.definition.timeout(sweep.options.profile)?;
        Ok(Self { lab: &sweep.definition.lab, set: sweep.options.timeout.or(own) })
    }

    pub(super) fn limit(&self, cell: &Cell) -> Option<Duration> {
        match self.set {
            Some(Timeout(set)) => set,
            None => Some(self.usual(cell)),
        }
    }

    pub(super) fn limit_of_counting(&self, cell: &Cell) -> Option<Duration> {
        let threads = cell.settings.threads.min(available_threads()) as u32;
        self.limit(cell).map(|limit| limit.saturating_mul(COUNTING.saturating_mul(threads)))
    }

    fn usual(&self, cell: &Cell) -> Duration {
        let Settings { spec, spp, scene, .. } = &cell.settings;
        if cell.external.is_some() || self.lab.workload_named(scene).is_some() {
            return OF_OTHERS;
        }
        let samples = f64::from(spec.width) * f64::from(spec.height) * f64::from(*spp);
        Duration::try_from_secs_f64(samples * OF_SAMPLE.as_secs_f64()).unwrap_or(Duration::MAX).max(LEAST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Definition, Options};
    use crate::files::Files;

    const TEXT: &str = "title = \"t\"\nquestion = \"q\"\nfigures = []\n[matrix]\nscene = [\"cornell\"]\nspp = [4, 400]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\n[[external]]\nname = \"other\"\nscene = \"cornell\"\nspp = [4]\nseed = [1]\ncommand = [\"{spp}\", \"{seed}\", \"{out}\"]\n[quick]\nsize = [100, 100]\n";

    /// The limits of two cells and of another program.
    fn limits(text: &str, option: Option<Timeout>) -> Vec<Option<Duration>> {
        let definition = Definition::from_text(&Lab::built_in(), "x", "x.toml", text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let options = Options { out: folder.path().to_path_buf(), timeout: option, ..Options::default() };
        let sweep = Sweep::new(&definition, &options, &mut Files::default()).unwrap();
        let limits = Limits::of(&sweep).unwrap();
        sweep.cells.iter().map(|cell| limits.limit(cell)).collect()
    }

    /// Without a limit of the user: a minute for 40,000 samples, 4000 s for 4 million, an hour for another program. The
    /// command's limit replaces the profile's, which replaces the file's.
    #[test]
    fn each_cell_has_the_nearest_limit() {
        let [minute, hour] = [60, 3600].map(|seconds| Some(Duration::from_secs(seconds)));
        assert_eq!(limits(TEXT, None), [minute, Some(Duration::from_secs(4000)), hour]);
        let file = format!("timeout = \"1h\"\n{TEXT}");
        assert_eq!(limits(&file, None), [hour; 3]);
        let profile = format!("{file}timeout = \"1min\"\n");
        assert_eq!(limits(&profile, None), [minute; 3]);
        assert_eq!(limits(&profile, Some(Timeout(None))), [None; 3]);
    }

    #[test]
    fn limits_are_durations_above_zero_or_none() {
        let parsed = |text: &str| Timeout::parse(text).map(|timeout| timeout.0);
        assert_eq!(parsed("10 min").unwrap(), Some(Duration::from_mins(10)));
        assert_eq!(parsed("1h 30m").unwrap(), Some(Duration::from_mins(90)));
        assert_eq!(parsed("none").unwrap(), None);
        for wrong in ["", "10", "0s", "-1s", "soon", "99999999999999999999999h", "None"] {
            let error = Timeout::parse(wrong).unwrap_err();
            let said = error.to_string();
            assert!(error.exit_code() == 2 && said.contains("timeout") && said.contains("10min"), "{wrong}: {said}");
        }
    }
}
