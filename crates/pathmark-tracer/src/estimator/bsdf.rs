//! `--estimator bsdf`: one direction at every vertex, sampled from the BSDF; smallpt's transport without its splitting.

use super::Compiled;
use super::path::{Path, Rules};

pub type Bsdf = Path<BsdfRules>;

#[derive(Debug, Clone, Copy)]
pub struct BsdfRules;

impl Rules for BsdfRules {
    const SPLITS: u16 = 0;
    const SPP_MULTIPLE: u32 = 1;
    const AIMS: bool = false;
    const COMPILED: Compiled = Compiled::EveryProfile;
}
