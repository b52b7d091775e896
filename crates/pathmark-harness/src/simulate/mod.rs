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
//! # Simplifications of the model
//!
//! * A job costs the same on every worker and beside every neighbour: no shared caches, memory bandwidth, clock rates or sibling threads.
//! * Each worker has its own processor. Only a thread per job is modelled with more threads than processors.
//! * A worker that finds no job stops; a real one searches on, which slows the others.
//! * Moving jobs between queues takes no extra time; real thieves pay more than owners.
//! * Threads that run a job cost more than empty ones (their stacks are touched, they are moved and preempted). A
//!   thread per job therefore looks too fast, by up to a tenth where jobs take a millisecond.
//! * Contention at a shared place is that of the largest number of threads that was measured.
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
