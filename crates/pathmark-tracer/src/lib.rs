//! The path tracer of `pathmark`: scenes, and the rendering of a piece of the film.
//!
//! It is a separate crate because it must be fast: it is optimised in every build and rebuilt only when it changes.
//! Users find its modules in the package `pathmark`, which adds the scheduling (who renders which piece when) and its
//! measurement.

// Tests may unwrap; the library returns errors to its user.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

#[doc(hidden)]
pub mod digest;
pub mod effect;
pub mod error;
pub mod estimator;
pub mod film;
#[doc(hidden)]
pub mod input;
pub mod kernel;
pub mod material;
pub mod math;
pub mod sampling;
pub mod scene;
