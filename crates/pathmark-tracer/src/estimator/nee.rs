//! `--estimator nee`: next-event estimation. At every vertex light is aimed at; what a path then arrives at by chance is not counted again.
//!
//! It counts where nothing was aimed at: behind mirrors and glass, seen by the camera, and light that is no target.

use super::Options;
use super::path::{Aimed, Light, Path};

/// The estimator.
pub(super) fn new(options: Options) -> Path<Aimed> {
    Path::aiming(Light::Aimed, options)
}
