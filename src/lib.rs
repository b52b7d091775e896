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
//! # Where to start
//!
//! * To put a pool, an estimator, a workload, a scene or an experiment of your own beside ours: [`Lab`]. The package's `examples/own_*.rs` are
//!   such programs.
//! * To test a pool of your own: [`strategy`], a crate without the renderer, and its contract.
//! * To render from a program, as above: [`measure::Setup`]; [`image_io`] writes the picture, [`metric`] compares two.
//! * To judge what was measured: [`analysis`], and [`simulate`] for workers that the machine does not have.
//!
//! | module | what is in it |
//! |--|--|
//! | [`lab`] | the tables as a value: what there is to choose from, and what a program adds |
//! | [`strategy`] | who runs which job, and when; the contract that every strategy keeps |
//! | [`measure`] | settings, runs, traces, records: where a strategy meets a kernel and a clock is read |
//! | [`kernel`] | how a piece of the film is rendered; workloads besides the path tracer |
//! | [`film`] | how a film is cut into pieces, and added up to the same bits |
//! | [`film_file`] | sums of a film in a file, and what they are of |
//! | [`scene`] | scenes from text and from files: shapes, lights, cameras, hierarchies |
//! | [`estimator`] | how the radiance along a path is estimated |
//! | [`material`] | what a surface does with light |
//! | [`sampling`] | random numbers by address, and warps with their densities |
//! | [`effect`] | sets of effects that kernels are compiled for |
//! | [`math`] | vectors, colours, rays, and formulas that round alike on every machine |
//! | [`image_io`] | pictures in files |
//! | [`metric`] | how far one picture is from another |
//! | [`analysis`] | statistics: intervals, speedup, scaling laws, prices |
//! | [`simulate`] | measured job costs on virtual workers |
//! | [`experiment`] | questions in TOML files, the cells that answer them, and their rows |
//! | [`check`] | the hard cases as a table |
//! | [`error`] | what can go wrong, and who has to act |
//!
//! Modules that are not listed serve the program `pathmark` and may change at any time.

// A test may unwrap; the library tells its user what is wrong.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

#[doc(hidden)]
pub mod atomic_file;
pub mod check;
#[cfg(feature = "program")]
mod cli;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod cluster;
#[doc(hidden)]
pub mod disk;
pub mod experiment;
#[doc(hidden)]
pub mod file_id;
#[doc(hidden)]
pub mod files;
pub mod film_file;
pub mod image_io;
pub mod lab;
#[doc(hidden)]
pub mod lock;
pub mod measure;
pub mod metric;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod plot;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod report;
pub mod simulate;
mod temporary;

pub use lab::Lab;
#[doc(inline)]
pub use pathmark_analysis as analysis;
#[doc(inline)]
pub use pathmark_strategy as strategy;
#[doc(hidden)]
pub use pathmark_tracer::simd;
use pathmark_tracer::{digest, input};
#[doc(inline)]
pub use pathmark_tracer::{effect, error, estimator, film, kernel, material, math, sampling, scene};
