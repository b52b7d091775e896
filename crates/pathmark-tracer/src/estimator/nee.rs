//! `--estimator nee`: next-event estimation. The path aims at a light from every vertex. Light that it then hits by
//! chance is not counted again.
//!
//! A hit counts where no light was aimed at: behind mirrors and glass, for camera rays, and on lights that are no
//! target.

use super::Options;
use super::path::{Aimed, Light, Path};

/// Creates the estimator.
pub(super) fn new(options: Options) -> Path<Aimed> {
    Path::aiming(Light::Aimed, options)
}
