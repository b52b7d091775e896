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
//! * To add your own pool, kernel, estimator, workload, scene or experiment: [`Lab`]. The package's `examples/custom_*.rs`
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
//! | [`machine`] | processors and caches of this machine, and the processors on which workers run |
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

#[cfg(feature = "program")]
use std::process::ExitCode;

pub use pathmark_harness::Lab;
#[doc(inline)]
pub use pathmark_harness::{
    analysis, effect, error, estimator, experiment, film, film_file, image_io, kernel, lab, machine, material, math,
    measure, metric, sampling, scene, simulate, strategy,
};
#[doc(hidden)]
pub use pathmark_harness::{atomic_file, cluster, disk, file_id, files, lock, sampler, shell, simd};

#[cfg(feature = "program")]
#[doc(inline)]
pub use pathmark_check as check;
#[cfg(feature = "program")]
pub use pathmark_cli::Allocator;
#[cfg(feature = "program")]
#[doc(hidden)]
pub use pathmark_report::{self as report, plot};

/// Runs the program with these tables and the process's arguments. This is `pathmark` with one workload more, for
/// `cargo run --release -- render squares --strategy rayon`:
///
/// ```no_run
/// use pathmark::Lab;
/// use pathmark::kernel::workload::{Item, Workload};
///
/// struct Squares;
///
/// impl Workload for Squares {
///     fn run(&self, item: &Item) -> [f64; 3] {
///         [(0..item.index()).map(|n| (n * n) as f64).sum(), 0.0, 0.0]
///     }
/// }
///
/// fn main() -> std::process::ExitCode {
///     pathmark::main(Lab::new().workload("squares", Squares))
/// }
/// ```
#[cfg(feature = "program")]
pub fn main(lab: Lab) -> ExitCode {
    pathmark_harness::experiment::embed(experiment::Texts {
        experiments: include!(concat!(env!("OUT_DIR"), "/experiments.rs")),
        claims: include!(concat!(env!("OUT_DIR"), "/claims.rs")),
    });
    pathmark_cli::main(lab)
}
