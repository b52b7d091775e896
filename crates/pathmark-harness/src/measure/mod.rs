//! The only place where a strategy meets a kernel, and where a clock is read.
//!
//! [`Settings`] say what to render, in which pieces, and on which workers; [`Setup::prepare`] checks them;
//! [`Setup::run`] renders, times and verifies; the result is a film, a [`Trace`] and a [`Record`]. [`Rounds`] add more
//! samples to an existing film. [`calibrate`] times strategies on empty jobs, for the simulator, and
//! [`run_bursts`] on short regions with gaps.

mod adaptive;
mod bursts;
mod calibration;
mod checkpoint;
mod chrome_trace;
mod column;
mod cut;
mod date;
mod external;
mod foreign_load;
mod goal;
mod history;
mod hybrid;
mod identity;
mod interleaved;
mod invalid;
mod ledger;
mod left_out;
mod machine;
mod merge;
mod output;
mod pilot;
mod processor;
mod provenance;
mod record;
mod rounds;
mod run;
mod setup;
mod share;
mod stamp;
mod timing_concerns;
mod trace;
mod trace_file;
mod usage;
mod warning;

pub use crate::lab::{SERIAL, THREAD_PER_ROW};
pub use crate::settings::{
    ImageKey, Kind, LARGEST_BYTES, LARGEST_SEED, LARGEST_SPP, SETTINGS, ScheduleKey, Setting, Settings,
    available_threads, image_columns, parse_size, schedule_columns, schedule_name,
};
pub use bursts::{BurstRow, Bursts, Spin, keeps_threads, run_bursts};
pub use calibration::{CalibrationRow, calibrate};
pub use checkpoint::{Checkpoint, Saved};
pub use chrome_trace::chrome_trace;
pub use column::Column;
pub use date::utc_now;
pub use external::{ExternalRun, missing_external, run_external};
pub use foreign_load::{ForeignLoad, ForeignShares};
pub use goal::{Between, CONFIDENCE, Extend, Goal, Position};
pub use history::History;
pub use interleaved::{Interleaved, interleaved};
pub use invalid::InvalidSample;
pub use left_out::LeftOut;
pub use machine::Machine;
pub use merge::{Merged, merge};
pub use output::{Entry as OutputEntry, OUTPUTS};
pub use provenance::Provenance;
pub use record::{COLUMNS, Measured, Record, SCHEMA, failure};
pub use rounds::Rounds;
pub use run::{Outcome, RoundTimes, Watch};
pub use setup::Setup;
pub use share::{DoneJob, MergedShare, Share};
pub use stamp::Stamp;
pub use timing_concerns::TimingConcerns;
pub use trace::{JobSpan, Trace};
pub use trace_file::{TraceFile, TraceHeader, TraceRow};
pub use warning::{WARNINGS, Warning, WarningEntry};
