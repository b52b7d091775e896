//! Warnings: facts that a reader of a record should know before trusting it.

use super::InvalidSample;
use std::fmt;

/// A doubt about a run; it is written to the record's `warnings`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Warning {
    /// Fewer threads ran jobs than were requested.
    WorkersUnused {
        /// Requested threads.
        asked: usize,
        /// Threads that ran jobs.
        used: u32,
    },
    /// More workers than processors.
    Oversubscribed { workers: u32, processors: usize },
    /// Other programs used the processors at the same time.
    ForeignLoad {
        /// Their share of all processors' time.
        percent: u32,
    },
    /// A virtual machine's host gave processors to others at the same time.
    Steal {
        /// Its share of all processors' time.
        percent: u32,
    },
    /// The time differs from earlier rows of the same cell.
    Drift {
        /// By how much longer (or shorter, if negative) than the median so far.
        percent: i32,
    },
    /// The run took more processor time than earlier rows of the same cell: processors share a core, or the clock was
    /// lower.
    Slowed {
        /// By how much more than the median so far.
        percent: i32,
    },
    /// The run is so short that its start-up matters.
    TooShort,
    /// The samples do not divide among the four subpixels, so the pixel's filter is not symmetric.
    PartialSubpixels,
    /// Time was up before the image reached the requested accuracy.
    TargetMissed,
    /// An earlier process rendered so many samples per pixel. Times are those of the last process.
    Resumed(u32),
    /// An option changes the limit of the image's convergence: clamped subpixels, or paths that are cut after some
    /// bounces.
    Biased,
    /// Rays left the scene.
    Escaped(u64),
    /// Paths were cut at the bounce limit.
    Truncated(u64),
    /// Triangles of the scene's meshes were left out because they have no area.
    LeftOut(usize),
    /// Samples were NaN, infinite or negative, and contributed nothing.
    InvalidSamples {
        /// Number of them.
        count: u64,
        /// The first of them; none if samples cannot be rendered again.
        first: Vec<InvalidSample>,
    },
    /// The external program is missing.
    NoProgram,
    /// The requested GPU is missing.
    NoDevice,
    /// The system's clock shows no date from 1970 to 9999.
    NoDate,
    /// The system does not report some facts, so their columns are empty and doubts that rest on them are not raised.
    Unmeasured(Vec<&'static str>),
    /// The program was built without optimisation for measuring.
    DebugBuild,
}

/// The meaning of a warning, and advice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WarningEntry {
    /// Its name, which stands before any bracket.
    pub name: &'static str,
    /// The condition under which a row has it.
    pub about: &'static str,
    /// The recommended action.
    pub advice: &'static str,
}

/// All warnings of rows.
pub const WARNINGS: &[WarningEntry] = &[
    WarningEntry {
        name: "workers-unused",
        about: "Fewer threads ran jobs than were requested.",
        advice: "Cut the image into more pieces, or request fewer threads: some of them found no work.",
    },
    WarningEntry {
        name: "oversubscribed",
        about: "There were more workers than processors.",
        advice: "Compare such rows only with rows of the same number of workers; a speedup cannot exceed the number of processors.",
    },
    WarningEntry {
        name: "foreign-load",
        about: "Other programs used more than 5 % of the processors during the run; up to schema 9 also the host of a virtual machine.",
        advice: "Close other programs and run the experiment again; trust ratios within a repetition more than seconds.",
    },
    WarningEntry {
        name: "steal",
        about: "The host of a virtual machine gave more than 5 % of the processors' time to others during the run.",
        advice: "Run the experiment again at another hour, or on a machine of your own; trust ratios within a repetition more than seconds.",
    },
    WarningEntry {
        name: "drift",
        about: "The time is more than a quarter away from the median of the cell's earlier rows.",
        advice: "Look for load, heat or a changing clock; more repetitions make the interval narrower.",
    },
    WarningEntry {
        name: "slowed",
        about: "The run needed over 15 % more processor time than the median of the cell's earlier rows, for the same work.",
        advice: "The clock was lower, or a virtual machine's host put two processors on one core: run again on a quiet machine.",
    },
    WarningEntry {
        name: "too-short",
        about: "The run took less than 5 ms, so starting threads and reading the clock affect the time.",
        advice: "Use a larger image or more samples per pixel.",
    },
    WarningEntry {
        name: "partial-subpixels",
        about: "The samples per pixel are not a multiple of 4, so the four subpixels have different numbers of samples.",
        advice: "Use a multiple of 4 samples per pixel with smallpt's box, or accept that the pixel filter is not symmetric.",
    },
    WarningEntry {
        name: "target-missed",
        about: "The time limit ended the render before it reached the target error.",
        advice: "Allow more time, or set a larger target error.",
    },
    WarningEntry {
        name: "resumed",
        about: "An earlier process rendered the first samples; times are those of the last process.",
        advice: "Do not use the row's times; the image is complete.",
    },
    WarningEntry {
        name: "biased",
        about: "An option changes what the image converges to: a clamp, a bounce limit, an epsilon or another pixel filter.",
        advice: "Compare the image only with renders under the same option.",
    },
    WarningEntry {
        name: "escaped",
        about: "Rays left a closed scene.",
        advice: "Look for gaps between the walls; `pathmark inspect path` shows single paths.",
    },
    WarningEntry {
        name: "truncated",
        about: "Paths were cut at the bounce limit, so their remaining light is missing.",
        advice: "Raise `--max-depth`, or use Russian roulette, which ends paths without bias.",
    },
    WarningEntry {
        name: "left-out-triangles",
        about: "Triangles of a mesh were left out because they have no area.",
        advice: "Nothing is missing from the image; clean the mesh if you want the warning gone.",
    },
    WarningEntry {
        name: "invalid-samples",
        about: "Samples were NaN, infinite or negative; they contribute nothing to the image.",
        advice: "Use `pathmark inspect path` with the place in the brackets to see the path, and report it as a fault.",
    },
    WarningEntry {
        name: "no-program",
        about: "The other program is not installed on this machine.",
        advice: "Install it, or start `pathmark` in the folder of its sources; the report leaves its rows out.",
    },
    WarningEntry {
        name: "no-device",
        about: "The row needs a GPU, but neither CUDA nor OpenCL finds one.",
        advice: "`pathmark list devices` says which libraries are missing; the report leaves the row out.",
    },
    WarningEntry {
        name: "no-date",
        about: "The system's clock shows no date from 1970 to 9999.",
        advice: "Set the clock; durations are measured with another clock and are correct.",
    },
    WarningEntry {
        name: "unmeasured",
        about: "The system does not report the facts in brackets: their columns are empty, and no row is in doubt because of them.",
        advice: "Measure on Linux if you need them; without the load of other programs, make sure that there is none. Counters need a kernel that grants them (`kernel.perf_event_paranoid` of 2 or less), and most virtual machines have none.",
    },
    WarningEntry {
        name: "debug-build",
        about: "The program was built without release optimisation.",
        advice: "Measure with `cargo run --release`.",
    },
];

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WorkersUnused { asked, used } => write!(f, "workers-unused({used} of {asked})"),
            Self::Oversubscribed { workers, processors } => write!(f, "oversubscribed({workers} on {processors})"),
            Self::ForeignLoad { percent } => write!(f, "foreign-load({percent} %)"),
            Self::Steal { percent } => write!(f, "steal({percent} %)"),
            Self::Drift { percent } => write!(f, "drift({percent:+} %)"),
            Self::Slowed { percent } => write!(f, "slowed({percent:+} % CPU)"),
            Self::TooShort => f.write_str("too-short"),
            Self::PartialSubpixels => f.write_str("partial-subpixels"),
            Self::TargetMissed => f.write_str("target-missed"),
            Self::Resumed(spp) => write!(f, "resumed(at {spp} spp)"),
            Self::Biased => f.write_str("biased"),
            Self::Escaped(count) => write!(f, "escaped({count})"),
            Self::Truncated(count) => write!(f, "truncated({count})"),
            Self::LeftOut(count) => write!(f, "left-out-triangles({count})"),
            Self::InvalidSamples { count, first } => {
                let places: Vec<String> = first.iter().map(ToString::to_string).collect();
                let at = if places.is_empty() { String::new() } else { format!(" at {}", places.join(" ")) };
                write!(f, "invalid-samples({count}{at})")
            }
            Self::NoProgram => f.write_str("no-program"),
            Self::NoDevice => f.write_str("no-device"),
            Self::NoDate => f.write_str("no-date"),
            Self::Unmeasured(facts) => write!(f, "unmeasured({})", facts.join(", ")),
            Self::DebugBuild => f.write_str("debug-build"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One of each kind; a new kind makes the match fail to compile until it is added.
    fn one_of_each() -> Vec<Warning> {
        let all = vec![
            Warning::WorkersUnused { asked: 2, used: 1 },
            Warning::Oversubscribed { workers: 2, processors: 1 },
            Warning::ForeignLoad { percent: 6 },
            Warning::Steal { percent: 7 },
            Warning::Drift { percent: 30 },
            Warning::Slowed { percent: 20 },
            Warning::TooShort,
            Warning::PartialSubpixels,
            Warning::TargetMissed,
            Warning::Resumed(4),
            Warning::Biased,
            Warning::Escaped(1),
            Warning::Truncated(1),
            Warning::LeftOut(1),
            Warning::InvalidSamples { count: 1, first: Vec::new() },
            Warning::NoProgram,
            Warning::NoDevice,
            Warning::NoDate,
            Warning::Unmeasured(vec!["peak memory"]),
            Warning::DebugBuild,
        ];
        for warning in &all {
            match warning {
                Warning::WorkersUnused { .. }
                | Warning::Oversubscribed { .. }
                | Warning::ForeignLoad { .. }
                | Warning::Steal { .. }
                | Warning::Drift { .. }
                | Warning::Slowed { .. }
                | Warning::TooShort
                | Warning::PartialSubpixels
                | Warning::TargetMissed
                | Warning::Resumed(_)
                | Warning::Biased
                | Warning::Escaped(_)
                | Warning::Truncated(_)
                | Warning::LeftOut(_)
                | Warning::InvalidSamples { .. }
                | Warning::NoProgram
                | Warning::NoDevice
                | Warning::NoDate
                | Warning::Unmeasured(_)
                | Warning::DebugBuild => {}
            }
        }
        all
    }

    #[test]
    fn every_warning_is_explained_once() {
        let named: Vec<String> = one_of_each()
            .iter()
            .map(|warning| warning.to_string().split('(').next().unwrap_or_default().to_string())
            .collect();
        let explained: Vec<&str> = WARNINGS.iter().map(|entry| entry.name).collect();
        assert_eq!(named, explained);
    }
}
