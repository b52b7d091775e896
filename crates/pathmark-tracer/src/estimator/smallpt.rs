//! `--estimator smallpt`: the estimator of Kevin Beason's smallpt (2008), which report A adopted.
//!
//! Glass is followed both ways at the first two vertices. Russian roulette by the largest albedo channel starts after
//! the fifth vertex. Samples cycle through 2x2 subpixels, so their number must be a multiple of four (smallpt silently
//! drops the rest).

use super::Compiled;
use super::path::{Path, Rules};

pub type Smallpt = Path<SmallptRules>;

#[derive(Debug, Clone, Copy)]
pub struct SmallptRules;

impl Rules for SmallptRules {
    const SPLITS: u16 = 2;
    const SPP_MULTIPLE: u32 = 4;
    const AIMS: bool = false;
    const COMPILED: Compiled = Compiled::EveryProfile;
}
