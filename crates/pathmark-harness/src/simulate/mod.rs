//! Simulated schedules: measured job costs on workers that this machine does not have.
//!
//! A replay takes the costs of all jobs in seconds, a strategy's [`Discipline`], a number of workers, the costs of the
//! mechanism ([`Overhead`], fitted to timed runs of empty jobs) and the processors ([`Hardware`]). It returns which
//! worker would run which job when. It is a pure function: no clock, no thread, seeded random numbers.
//!
//! ```
//! use pathmark_harness::simulate::{Hardware, Overhead, bounds, replay};
//! use pathmark_harness::strategy::find;
//!
//! let discipline = find("shared-counter").expect("it is in the table").discipline;
//! let costs = [3.0, 1.0, 1.0, 1.0];
//! let replayed = replay(&costs, discipline, 2, &Overhead::default(), &Hardware::default());
//! assert_eq!(replayed.makespan_s, 3.0);
//! assert_eq!(bounds(&costs, 2).lower_s, 3.0);
//! # Ok::<(), pathmark_harness::strategy::StrategyError>(())
//! ```
//!
//! docs/simulation.md says what the model leaves out.
//!
//! [`Discipline`]: crate::strategy::Discipline

mod contender;
mod forecast;
mod hardware;
mod inflation;
mod overhead;
mod prediction;
mod ranks;
mod replay;

pub use contender::{Contender, LONGEST_FIRST, Order, contenders};
pub use forecast::{Bounds, Forecast, bounds, forecast, longest_first, typical_costs};
pub use hardware::Hardware;
pub use inflation::{BusyRatio, WorkInflation};
pub use overhead::{Overhead, Overheads};
pub use prediction::{DISTURBED, Observed, Prediction, RelativeErrors, busy_ratios, predict, relative_errors};
pub use ranks::{Cluster, Crew, Messages};
pub use replay::{Replay, replay};
