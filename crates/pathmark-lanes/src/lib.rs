//! Fast kernels for the path tracer of `pathmark`: paths in SIMD lanes, on devices, and on both together. In double
//! precision they produce the bits of the scalar kernel.
//!
//! It is a crate of its own, so that it compiles beside the readable kernel, and an edit of one does not rebuild the
//! other. Users find its modules in the package `pathmark`.

// Tests may unwrap; the library returns errors to its user.
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

#[cfg(feature = "device")]
mod device;
pub mod kernel;
mod lanes;
mod level;
mod processor;
pub mod sampler;
pub mod simd;
