//! The only place where a strategy meets a kernel, and where a clock is read.
//!
//! [`Settings`] say what to render, in which pieces, and on which workers; [`Setup::prepare`] checks them;
//! [`Setup::run`] renders, times and verifies; the result is a film, a [`Trace`] and a [`Record`]. [`Rounds`] add more
//! samples to an existing film. [`calibrate`] times strategies on empty jobs, for the simulator, and
//! [`run_bursts`] on short regions with gaps.

mod adaptive;
mod batch;
mod bursts;
mod calibration;
mod checkpoint;
mod chrome_trace;
mod column;
mod counters;
mod cut;
mod equal_pairs;
mod external;
mod goal;
mod history;
mod hybrid;
mod identity;
mod interleaved;
mod ledger;
mod left_out;
mod machine;
mod merge;
mod observed;
mod output;
mod provenance;
mod record;
mod rounds;
mod run;
mod setup;
mod share;
mod timing_concerns;
mod trace;
mod usage;
mod warning;

pub use crate::lab::{SERIAL, THREAD_PER_ROW};
pub use crate::settings::{
    ImageKey, Kind, LARGEST_BYTES, LARGEST_SEED, LARGEST_SPP, SETTINGS, ScheduleKey, Seconds, Setting, Settings,
    available_threads, image_columns, parse_size, schedule_columns, schedule_name,
};
pub use batch::batch_runs;
pub use bursts::{BurstRow, Bursts, Spin, keeps_threads, run_bursts};
pub use calibration::{
    CALIBRATIONS, CalibrationRow, calibrate, joined_calibrations, read_calibration, write_calibrations,
};
pub use checkpoint::{Checkpoint, Saved};
pub use chrome_trace::chrome_trace;
pub use column::Column;
pub use equal_pairs::{EqualPairs, equal_pairs};
pub use external::{ExternalRun, missing_external, run_external};
pub use goal::{Between, CONFIDENCE, Extend, Goal, Position};
pub use history::{History, InvalidSample};
pub use interleaved::{Interleaved, interleaved};
pub use left_out::LeftOut;
pub use machine::Machine;
pub use merge::{Merged, merge};
pub use output::{Entry as OutputEntry, OUTPUTS};
pub use provenance::{Provenance, Stamp, utc_now};
pub use record::{COLUMNS, Record, SCHEMA, failure};
pub use rounds::Rounds;
pub use run::{Outcome, RoundTimes, Watch};
pub use setup::Setup;
pub use share::{DoneJob, MergedShare, Share};
pub use timing_concerns::TimingConcerns;
pub use trace::{JobSpan, Trace, TraceFile, TraceHeader, TraceRow};
pub use usage::{ForeignLoad, ForeignShares};
pub use warning::{WARNINGS, Warning, WarningEntry};
