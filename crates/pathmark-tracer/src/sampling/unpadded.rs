//! A `SplitMix64` generator for each thread, side by side in memory: `--sampler unpadded`, wrong on purpose.
//!
//! No thread uses the state of another one, and the numbers are as good as those of `padded`. But eight states share a cache
//! line, and a processor must own a line to write to it: at every number it takes the line from the others (false sharing).

use super::{Address, Padded, Sampler};

/// The sampler.
#[derive(Debug)]
pub struct Unpadded(Padded);

impl Unpadded {
    /// Creates a sampler with this seed and a state per thread, without a gap between two states.
    pub fn new(seed: u64) -> Self {
        Self(Padded::apart(seed, 1))
    }
}

impl Sampler for Unpadded {
    fn pair(&self, at: Address) -> [f64; 2] {
        self.0.pair(at)
    }
}
