//! Pathmark: how should many unequal jobs be scheduled on many cores, and what does accuracy cost in time?
//!
//! The workload is a deterministic, seeded path tracer of the smallpt family. The code keeps three axes independent:
//! *what* is rendered ([`scene`], [`estimator`], [`sampling`], [`kernel`]), in which *pieces* ([`film`]), and *who*
//! renders them when ([`strategy`]). They meet in [`measure`], which times the jobs.
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
//! * To add your own pool, kernel, estimator, workload, scene or experiment: [`Lab`]. The package's `examples/own_*.rs`
//!   and `examples/custom_kernel.rs` are such programs.
//! * To test your own pool: [`strategy`], a crate without the renderer, and its contract.
//! * To render from a program, as above: [`measure::Setup`]; [`image_io`] writes the picture, [`metric`] compares two.
//! * To analyse measurements: [`analysis`], and [`simulate`] for workers that the machine does not have.
//!
//! | module | contents |
//! |--|--|
//! | [`lab`] | the tables of all choices: the built-in ones, and those that a program adds |
//! | [`strategy`] | which worker runs which job, and when; the contract that every strategy keeps |
//! | [`measure`] | settings, runs, traces, records: runs kernels with strategies and reads the clock |
//! | [`kernel`] | kernels that render a piece of the film; workloads besides the path tracer |
//! | [`film`] | decomposition of a film into pieces, and sums with the same bits for all of them |
//! | [`film_file`] | files with the sums of a film, and the scene and settings that they belong to |
//! | [`scene`] | scenes from text and from files: shapes, lights, cameras, hierarchies |
//! | [`estimator`] | how the radiance along a path is estimated |
//! | [`material`] | materials: how a surface scatters light |
//! | [`sampling`] | random numbers by address, and warps with their densities |
//! | [`effect`] | sets of effects that kernels are compiled for |
//! | [`math`] | vectors, colours, rays, and formulas that round equally on every machine |
//! | [`image_io`] | pictures in files |
//! | [`metric`] | error metrics between two pictures |
//! | [`analysis`] | statistics: intervals, speedup, scaling laws, prices |
//! | [`simulate`] | replays of measured job costs on virtual workers |
//! | [`experiment`] | questions in TOML files, the cells that answer them, and their rows |
//! | [`check`] | the hard cases as a table |
//! | [`error`] | errors, and who has to act on them |
//!
//! Modules that are not listed serve the program `pathmark` and may change at any time.

// Tests may unwrap; the library returns errors that say what is wrong.
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
#[doc(hidden)]
pub mod shell;
pub mod simulate;
mod temporary;

#[cfg(feature = "program")]
pub use cli::Allocator;
pub use lab::Lab;
#[doc(inline)]
pub use pathmark_analysis as analysis;
#[doc(inline)]
pub use pathmark_lanes::kernel;
#[doc(hidden)]
pub use pathmark_lanes::{sampler, simd};
#[doc(inline)]
pub use pathmark_strategy as strategy;
use pathmark_tracer::{digest, input};
#[doc(inline)]
pub use pathmark_tracer::{effect, error, estimator, film, material, math, sampling, scene};
