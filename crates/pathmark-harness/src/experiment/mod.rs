//! An experiment: a question in a TOML file, the cells that answer it, and a row for every repetition of every cell.
//!
//! To add one, write `experiments/NAME.toml`: the build embeds every file there, and `pathmark run path/to/NAME.toml` runs any other.

mod baseline;
mod cell;
mod cell_process;
mod comparisons;
mod conversation;
mod count_diff;
mod definition;
mod diff;
mod doctor;
mod drift;
mod external;
mod grading;
mod image_bits;
mod instructions;
mod keys;
mod matrix;
mod merge_sweeps;
mod object_pixels;
mod overrides;
mod packed_rows;
mod pairs;
mod plan;
mod power;
mod pricing;
mod process_group;
mod processes;
mod profile;
mod ranking;
mod records_file;
mod reference;
mod replication;
#[cfg(test)]
mod replication_tests;
mod run_file;
mod running;
mod second_stage;
#[cfg(test)]
mod setting_tests;
mod shuffle;
mod sides;
mod statements;
mod stopping_rule;
mod sweep;
mod sweep_shard;
mod table;
mod texts;
mod time_limit;
mod together;
mod turns;

pub use crate::measure::read_calibration;
pub use baseline::baseline_folder;
pub use cell::{Cell, CellPoint, SceneVersion, trace_file};
pub use cell_process::{CELL_ABOUT, CellJob, PointJob, child_main};
pub use count_diff::{CountDiff, CountDiffs, count_diff};
pub use definition::{Chapter, Definition, Keep};
pub use diff::{Across, CellDiff, Change, Diff, diff, parse_share};
pub use doctor::{DOCTOR, Examination, Noise};
pub use external::{EXTERNAL, External};
pub use grading::{BrokenPromise, Candidate, Grade, Rows, Trial, grades, own_checksum};
pub use image_bits::{ImageBits, SameBits};
pub use keys::keys;
pub use matrix::LARGEST_REPETITIONS;
pub use merge_sweeps::{MergedSweep, merge_sweeps};
pub use packed_rows::{has_records, records_path};
pub use plan::{Plan, Prices};
pub use power::Power;
pub use pricing::{Paid, Pilot, Piloted, law_of, pay, run_pilots};
pub use processes::MESSAGES;
pub use profile::Profile;
pub use ranking::{ImageRanking, Place, Ranking, ranking};
pub use records_file::{RecordsFile, read_records};
pub use reference::{
    HalfFile, Reference, ReferenceError, check_until, reference_seed, refine_reference, render_reference,
    wanted_references,
};
pub use replication::{MachineFact, REPLICATION, Replication, Statements, Theirs};
pub use run_file::{MACHINE, RunFile, read_run_file};
pub use sides::{Compared, FailedCell, Lost};
pub use statements::{JOINT_LEVEL, Kind, Reproduction, Statement};
pub use stopping_rule::{Goal, MOST_REPETITIONS, StoppingRule};
pub use sweep::{Options, Summary, Sweep};
pub use sweep_shard::SweepShard;
pub use texts::{Named, Texts, claims, embed, experiments};
pub use time_limit::{TIMED_OUT, Timeout};
pub use turns::turns;

/// Receives the progress of long work. The command line implements it.
pub trait Progress: Sync {
    fn begin(&self, title: &str, total: u64);
    fn advance(&self, done: u64);
    fn note(&self, text: &str);
    fn end(&self);
}
