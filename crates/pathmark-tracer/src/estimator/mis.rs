//! `--estimator mis`: multiple importance sampling. Light is aimed at as well as hit by chance, and each way is
//! weighted by its density with the power heuristic (Veach and Guibas, "Optimally Combining Sampling Techniques for
//! Monte Carlo Rendering", 1995).

use super::Options;
use super::path::{Aimed, Light, Path};

/// Creates the estimator.
pub(super) fn new(options: Options) -> Path<Aimed> {
    Path::aiming(Light::Weighted, options)
}
