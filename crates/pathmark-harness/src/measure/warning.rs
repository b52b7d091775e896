//! Warnings: facts that a reader of a record should know before trusting it.

use super::InvalidSample;
use std::fmt;

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

macro_rules! warnings {
    (detail) => { "" };
    (detail $detail:expr) => { $detail };
    ($(
        $kind:ident $(($($place:ident: $place_type:ty),+))? $({ $($field:ident: $type:ty),+ })?,
        $name:literal $(+ $detail:expr)?,
        $about:literal,
        $advice:literal;
    )+) => {
        /// A doubt about a run; it is written to the record's `warnings`.
        #[derive(Debug, Clone, PartialEq, Eq)]
        pub enum Warning {
            $(#[doc = $about] $kind $(($($place_type),+))? $({ $($field: $type),+ })?,)+
        }

        /// All warnings of rows.
        pub const WARNINGS: &[WarningEntry] = &[$(WarningEntry { name: $name, about: $about, advice: $advice }),+];

        impl fmt::Display for Warning {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$kind $(($($place),+))? $({ $($field),+ })? => {
                        write!(f, "{}{}", $name, warnings!(detail $($detail)?))
                    })+
                }
            }
        }
    };
}

// Each warning: its name in a row, followed by details; when a row has it; what to do about it.
warnings! {
    WorkersUnused { asked: usize, used: u32 }, "workers-unused" + format!("({used} of {asked})"),
        "Fewer threads ran jobs than were requested.",
        "Cut the image into more pieces, or request fewer threads: some of them found no work.";
    Oversubscribed { workers: u32, processors: usize }, "oversubscribed" + format!("({workers} on {processors})"),
        "There were more workers than processors.",
        "Compare such rows only with rows of the same number of workers; a speedup cannot exceed the number of processors.";
    ForeignLoad { percent: u32 }, "foreign-load" + format!("({percent} %)"),
        "Other programs used more than 5 % of the processors during the run; up to schema 9 also the host of a virtual machine.",
        "Close other programs and run the experiment again; trust ratios within a repetition more than seconds.";
    Steal { percent: u32 }, "steal" + format!("({percent} %)"),
        "The host of a virtual machine gave more than 5 % of the processors' time to others during the run.",
        "Run the experiment again at another hour, or on a machine of your own; trust ratios within a repetition more than seconds.";
    Drift { percent: i32 }, "drift" + format!("({percent:+} %)"),
        "The time is more than a quarter away from the median of the cell's earlier rows.",
        "Look for load, heat or a changing clock; more repetitions make the interval narrower.";
    Slowed { percent: i32 }, "slowed" + format!("({percent:+} % CPU)"),
        "The run needed over 15 % more processor time than the median of the cell's earlier rows, for the same work.",
        "The clock was lower, or a virtual machine's host put two processors on one core: run again on a quiet machine.";
    TooShort, "too-short",
        "The run took less than 5 ms (a serial one less than 2 ms), so starting threads and reading the clock affect the time.",
        "Use a larger image or more samples per pixel.";
    PartialSubpixels, "partial-subpixels",
        "The samples per pixel are not a multiple of 4, so the four subpixels have different numbers of samples.",
        "Use a multiple of 4 samples per pixel with smallpt's box, or accept that the pixel filter is not symmetric.";
    TargetMissed, "target-missed",
        "The time limit ended the render before it reached the target error.",
        "Allow more time, or set a larger target error.";
    Resumed(spp: u32), "resumed" + format!("(at {spp} spp)"),
        "An earlier process rendered the first samples; times are those of the last process.",
        "Do not use the row's times; the image is complete.";
    Biased, "biased",
        "An option changes what the image converges to: a clamp, a bounce limit, an epsilon or another pixel filter.",
        "Compare the image only with renders under the same option.";
    Escaped(count: u64), "escaped" + format!("({count})"),
        "Rays left a closed scene.",
        "Look for gaps between the walls; `pathmark inspect path` shows single paths.";
    Truncated(count: u64), "truncated" + format!("({count})"),
        "Paths were cut at the bounce limit, so their remaining light is missing.",
        "Raise `--max-depth`, or use Russian roulette, which ends paths without bias.";
    LeftOut(count: usize), "left-out-triangles" + format!("({count})"),
        "Triangles of a mesh were left out because they have no area.",
        "Nothing is missing from the image; clean the mesh if you want the warning gone.";
    InvalidSamples { count: u64, first: Vec<InvalidSample> }, "invalid-samples" + format!("({count}{})", places(first)),
        "Samples were NaN, infinite or negative; they contribute nothing to the image.",
        "Use `pathmark inspect path` with the place in the brackets to see the path, and report it as a fault.";
    NoProgram, "no-program",
        "The other program is not installed on this machine.",
        "Install it, or start `pathmark` in the folder of its sources; the report leaves its rows out.";
    NoDevice, "no-device",
        "The row needs a GPU, but neither CUDA nor OpenCL finds one.",
        "`pathmark list devices` says which libraries are missing; the report leaves the row out.";
    NoDate, "no-date",
        "The system's clock shows no date from 1970 to 9999.",
        "Set the clock; durations are measured with another clock and are correct.";
    Unmeasured(facts: Vec<&'static str>), "unmeasured" + format!("({})", facts.join(", ")),
        "The system does not report the facts in brackets: their columns are empty, and no row is in doubt because of them.",
        "Measure on Linux if you need them; without the load of other programs, make sure that there is none. Counters need a kernel that grants them (`kernel.perf_event_paranoid` of 2 or less), and most virtual machines have none.";
    DebugBuild, "debug-build",
        "The program was built without release optimisation.",
        "Measure with `cargo run --release`.";
}

/// The places of invalid samples; empty if samples cannot be rendered again.
fn places(first: &[InvalidSample]) -> String {
    let places: Vec<String> = first.iter().map(ToString::to_string).collect();
    if places.is_empty() { String::new() } else { format!(" at {}", places.join(" ")) }
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
