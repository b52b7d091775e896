//! Pathmark: how should many unequal pieces of work be scheduled on many cores, and what does accuracy cost in time?
//!
//! The workload is a deterministic, seeded path tracer of the smallpt family. Three axes are never multiplied in code: *what* is rendered
//! ([`scene`], [`estimator`], [`sampling`], [`kernel`]), in which *pieces* ([`film`]), and *who* renders them when ([`strategy`]). They
//! meet in [`measure`], the only place that reads a clock.
//!
//! ```
//! use pathmark::measure::{Settings, Setup};
//! use pathmark::kernel::Spec;
//!
//! let settings = Settings {
//!     scene: "cornell".into(),
//!     spp: 4,
//!     spec: Spec { width: 16, height: 12, seed: 7, ..Spec::default() },
//!     decomposition: "tiles:8x8".into(),
//!     strategy: "work-stealing".into(),
//!     threads: 2,
//!     ..Settings::default()
//! };
//! let outcome = Setup::prepare(settings)?.run(None)?;
//! assert_eq!(outcome.counts.paths, 16 * 12 * 4);
//! # Ok::<(), pathmark::error::Error>(())
//! ```
//!
//! Layers, each importing only those above it: `error`, `digest`, `effect`, `math`, `input`,
//! `disk`, `file_id`, `lock`, `temporary`, `atomic_file`, `files`; `image_io`, `metric`, `sampling`, `analysis`; `material`;
//! `scene`; `film`, `estimator`; `kernel`; `strategy` (which imports nothing of ours); `measure`; `simulate`; `experiment`, `check`;
//! `plot`, `report`; `cli`.

// A test may unwrap; the library tells its user what is wrong.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod analysis;
pub mod atomic_file;
pub mod check;
#[cfg(feature = "program")]
pub mod cli;
pub mod digest;
pub mod disk;
pub mod effect;
pub mod error;
pub mod estimator;
pub mod experiment;
pub mod file_id;
pub mod files;
pub mod film;
pub mod image_io;
pub mod input;
pub mod kernel;
pub mod lab;
pub mod lock;
pub mod material;
pub mod math;
pub mod measure;
pub mod metric;
#[cfg(feature = "program")]
pub mod plot;
#[cfg(feature = "program")]
pub mod report;
pub mod sampling;
pub mod scene;
pub mod simd;
pub mod simulate;
mod temporary;

pub use lab::Lab;
#[doc(inline)]
pub use pathmark_strategy as strategy;
