//! The path tracer of `pathmark`: what is rendered, and how a piece of the film is.
//!
//! A crate of its own, because it is what has to be fast: it is optimised in every build, and built again only when it changes. Users find its
//! modules in the package `pathmark`, which adds who renders which piece when, and measures that.

// A test may unwrap; the library tells its user what is wrong.
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
#[doc(hidden)]
pub mod simd;
