//! `--estimator smallpt`: the estimator of Kevin Beason's smallpt (2008), which report A took over.
//!
//! Glass is followed both ways at the first two vertices; roulette by the largest albedo channel starts after the fifth vertex; samples
//! go to 2x2 subpixels in turn, so their number must be a multiple of four (smallpt drops the rest without a word).

use super::Options;
use super::path::{MAX_BOUNCES, Rules};

/// The estimator.
#[derive(Debug, Clone, Copy)]
pub struct Smallpt {
    max_depth: u16,
}

impl Smallpt {
    /// The estimator; without a depth of its own it follows paths to [`MAX_BOUNCES`].
    pub fn new(options: Options) -> Self {
        Self { max_depth: options.max_depth.unwrap_or(MAX_BOUNCES) }
    }
}

impl Rules for Smallpt {
    const SPLITS: u16 = 2;
    const SPP_MULTIPLE: u32 = 4;

    #[inline(always)]
    fn max_depth(&self) -> u16 {
        self.max_depth
    }
}
