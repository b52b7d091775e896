//! Pathmark.
pub mod atomic_file;
pub mod error;
pub mod estimator;
pub mod film;
pub mod image_io;
pub mod input;
pub mod kernel;
pub mod material;
pub mod math;
pub mod sampling;
pub mod scene;
