//! `--estimator bsdf`: one direction at every vertex, chosen by the surface; smallpt's transport without its splitting.

use super::path::Rules;

/// The estimator.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bsdf;

impl Rules for Bsdf {
    const SPLITS: u16 = 0;
    const SPP_MULTIPLE: u32 = 1;
}
