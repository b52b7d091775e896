//! `--estimator smallpt`: the estimator of Kevin Beason's smallpt (2008), which report A took over.
//!
//! Glass is followed both ways at the first two vertices; roulette by the largest albedo channel starts after the fifth vertex; samples
//! go to 2x2 subpixels in turn, so their number must be a multiple of four (smallpt drops the rest without a word).

use super::Compiled;
use super::path::{Path, Rules};

/// The estimator.
pub type Smallpt = Path<SmallptRules>;

/// What sets it apart.
#[derive(Debug, Clone, Copy)]
pub struct SmallptRules;

impl Rules for SmallptRules {
    const SPLITS: u16 = 2;
    const SPP_MULTIPLE: u32 = 4;
    const AIMS: bool = false;
    const COMPILED: Compiled = Compiled::EveryProfile;
}
