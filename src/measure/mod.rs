//! The only place where a strategy meets a kernel, and where a clock is read.
//!
//! [`Settings`] say what to render, in which pieces, and who does it; [`Setup::prepare`] checks them; [`Setup::run`] renders, times and
//! verifies; the result is a film, a [`Trace`] and a [`Record`].

mod chrome_trace;
mod machine;
mod record;
mod settings;
mod setup;
mod slots;
mod trace;
mod usage;
mod warning;

pub use chrome_trace::chrome_trace;
pub use machine::Machine;
pub use record::{Measured, Record, SCHEMA, failure};
pub use settings::{LARGEST_SEED, Settings, THREAD_PER_ROW, available_threads, schedule_name};
pub use setup::{Outcome, Setup};
pub use trace::{JobSpan, Trace};
pub use warning::Warning;
