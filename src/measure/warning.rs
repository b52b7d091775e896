//! What a reader of a record should know before believing it.

use super::InvalidSample;
use std::fmt;

/// A doubt about a run; it goes into the record's `warnings`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Warning {
    /// Fewer threads did work than were asked for.
    WorkersUnused {
        /// Asked for.
        asked: usize,
        /// Used.
        used: u32,
    },
    /// More workers than processors.
    Oversubscribed {
        /// Workers.
        workers: u32,
        /// Processors.
        processors: usize,
    },
    /// Other programs used the processors at the same time.
    ForeignLoad {
        /// Their share of all processors' time.
        percent: u32,
    },
    /// The same cell took another time before.
    Drift {
        /// By how much longer (or shorter, if negative) than the median so far.
        percent: i32,
    },
    /// The same cell took less processor time before: processors that share a core, or a lower clock.
    Slowed {
        /// By how much more than the median so far.
        percent: i32,
    },
    /// The run ended before its beginning stopped to matter.
    TooShort,
    /// The samples do not divide among the four subpixels, so the pixel's filter is lopsided.
    PartialSubpixels,
    /// Time was up before the image was as accurate as asked for.
    TargetMissed,
    /// So many samples a pixel are an earlier process's: times and counts are of the others.
    Resumed(u32),
    /// Something changes what the image converges to: clamped subpixels, or paths that are cut after some bounces.
    Biased,
    /// Rays left the scene.
    Escaped(u64),
    /// Paths were cut at the bounce limit.
    Truncated(u64),
    /// Triangles of the scene's meshes were left out because they have no area.
    LeftOut(usize),
    /// Samples were NaN, infinite or negative, and contributed nothing.
    InvalidSamples {
        /// How many.
        count: u64,
        /// The first of them; none where samples cannot be had again.
        first: Vec<InvalidSample>,
    },
    /// The other program that was to be run is not there.
    NoProgram,
    /// The system's clock shows no date from 1970 to 9999.
    NoDate,
    /// The program was built without optimisation for measuring.
    DebugBuild,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WorkersUnused { asked, used } => write!(f, "workers-unused({used} of {asked})"),
            Self::Oversubscribed { workers, processors } => write!(f, "oversubscribed({workers} on {processors})"),
            Self::ForeignLoad { percent } => write!(f, "foreign-load({percent} %)"),
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
            Self::NoDate => f.write_str("no-date"),
            Self::DebugBuild => f.write_str("debug-build"),
        }
    }
}
