//! `--estimator bsdf`: one direction at every vertex, chosen by the surface; smallpt's transport without its splitting.

use super::Options;
use super::path::{MAX_BOUNCES, Rules};

/// The estimator.
#[derive(Debug, Clone, Copy)]
pub struct Bsdf {
    max_depth: u16,
}

impl Bsdf {
    /// The estimator; without a depth of its own it follows paths to [`MAX_BOUNCES`].
    pub fn new(options: Options) -> Self {
        Self { max_depth: options.max_depth.unwrap_or(MAX_BOUNCES) }
    }
}

impl Rules for Bsdf {
    const SPLITS: u16 = 0;
    const SPP_MULTIPLE: u32 = 1;

    #[inline(always)]
    fn max_depth(&self) -> u16 {
        self.max_depth
    }
}
