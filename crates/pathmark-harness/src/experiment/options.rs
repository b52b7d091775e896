//! The options with which an experiment is run: those of the command line.

use super::{Profile, StoppingRule, SweepShard, Timeout};
use std::path::PathBuf;

/// Options of a sweep.
#[derive(Debug, Clone)]
pub struct Options {
    /// The parent of the experiment's folder and of the references' folder.
    pub out: PathBuf,
    /// The size at which the experiment is run.
    pub profile: Profile,
    /// Whether to continue with the rows that the folder already has.
    pub resume: bool,
    /// Repetitions of each cell; `None` for the definition's number.
    pub repetitions: Option<u32>,
    /// Filters `field=value,value...`: a cell is run if it has one of the values of each filter.
    pub filters: Vec<String>,
    /// Another build of the program, which also runs each repetition of each cell.
    pub baseline: Option<PathBuf>,
    /// The part of the cells to run; `None` for all.
    pub shard: Option<SweepShard>,
    /// The figure that compares with serial runs. Filters then keep the serial runs, and there must be at least one.
    pub serial_for: Option<&'static str>,
    /// The goal at which repetitions stop; `None` for the definition's.
    pub until: Option<StoppingRule>,
    /// The time limit of each cell; `None` for the definition's.
    pub timeout: Option<Timeout>,
    /// Whether cells with doubtful rows are run again.
    pub rerun_doubtful: bool,
    /// Whether the instructions of each cell are counted, too.
    pub count_instructions: bool,
    /// The command as the user gave it.
    pub command: String,
}

impl Options {
    /// The options of a command without options.
    pub fn usual(out: PathBuf) -> Self {
        Self {
            out,
            profile: Profile::Quick,
            resume: false,
            repetitions: None,
            filters: Vec::new(),
            baseline: None,
            shard: None,
            serial_for: None,
            until: None,
            timeout: None,
            rerun_doubtful: false,
            count_instructions: false,
            command: String::new(),
        }
    }
}
