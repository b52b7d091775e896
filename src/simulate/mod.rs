//! Measured job costs on workers that this machine does not have.
//!
//! A replay takes the costs of all jobs in seconds, a strategy's [`Discipline`], a number of workers, what the mechanism costs
//! ([`Overhead`], fitted to timed runs of empty jobs) and what the workers run on ([`Hardware`]), and says who would do what when. It is
//! a pure function: no clock, no thread, seeded random numbers.
//!
//! ```
//! use pathmark::simulate::{Hardware, Overhead, bounds, replay};
//! use pathmark::strategy::find;
//!
//! let discipline = find("shared-counter").expect("it is in the table").discipline;
//! let costs = [3.0, 1.0, 1.0, 1.0];
//! let replayed = replay(&costs, discipline, 2, &Overhead::default(), &Hardware::default());
//! assert_eq!(replayed.makespan_s, 3.0);
//! assert_eq!(bounds(&costs, 2).lower_s, 3.0);
//! # Ok::<(), pathmark::strategy::StrategyError>(())
//! ```
//!
//! # What the model leaves out
//!
//! * A job costs the same on every worker and beside every neighbour: no shared caches, memory bandwidth, clock rates or sibling threads.
//! * A worker has a processor of its own. More workers than processors are modelled for a thread per job alone.
//! * A worker that finds nothing goes home; real ones search on, and take something of the others by it.
//! * Moving jobs between queues takes no time of its own; real thieves pay more than owners do.
//! * Threads that run a job cost more than empty ones (their stacks are touched, they are moved and preempted), so a thread per job
//!   comes out too well, by up to a tenth where jobs take a millisecond.
//! * The contention at a place that all share is that of the largest number of threads that was measured.
//!
//! [`Discipline`]: crate::strategy::Discipline

mod agreement;
mod bounds;
mod contender;
mod forecast;
mod hardware;
mod overhead;
mod prediction;
mod ranks;
mod replay;

pub use agreement::{Agreement, agreement};
pub use bounds::{Bounds, bounds, longest_first};
pub use contender::{Contender, Order, contenders};
pub use forecast::{Forecast, forecast};
pub use hardware::{Hardware, Noise, Speeds};
pub use overhead::{Overhead, Overheads};
pub use prediction::{DISTURBED, Observed, Prediction, predict};
pub use ranks::{Cluster, Crew, Messages};
pub use replay::{Replay, replay};
