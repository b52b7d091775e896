//! `--estimator mis`: light is aimed at as well as arrived at, each weighted by how likely it was to be found that way: multiple importance
//! sampling with the power heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995).

use super::Options;
use super::path::{Aimed, Light, Path};

/// The estimator.
pub(super) fn new(options: Options) -> Path<Aimed> {
    Path::aiming(Light::Weighted, options)
}
