//! The harness of `pathmark`: runs kernels under scheduling strategies and measures them. Settings, runs, traces, rows,
//! sweeps, and replays on virtual workers.
//!
//! Users find its modules in the package `pathmark`, which adds the program.

// Tests may unwrap; the library returns errors that say what is wrong.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod atomic_file;
pub mod cases_file;
pub mod cluster;
pub mod csv_file;
pub mod disk;
pub mod experiment;
pub mod file_id;
pub mod files;
pub mod film_file;
pub mod guard_prices;
pub mod image_io;
pub mod lab;
pub mod lock;
pub mod machine;
pub mod measure;
pub mod metric;
mod settings;
pub mod shell;
pub mod simulate;
mod temporary;

pub use lab::Lab;
pub use pathmark_analysis as analysis;
pub use pathmark_lanes::{kernel, sampler, simd};
pub use pathmark_strategy as strategy;
pub use pathmark_tracer::{digest, effect, error, estimator, film, input, material, math, sampling, scene};
