//! The same seed in every thread: `--sampler same-seed`, wrong on purpose.
//!
//! A program that seeds the generator of each thread with one number, such as the time in seconds, draws the same numbers in
//! all of them. Nothing waits and nothing fails; only the noise of the image repeats. Where all pixels have the same
//! integrand and T threads get equal shares, each share is a copy of the others, so the image holds 1/T of the samples that
//! it has paid for: the variance of its mean is T times as large, while the error of a pixel is unchanged. The right way is
//! `per-thread`.

use super::{Address, PerThread, Sampler};

/// The sampler.
#[derive(Debug)]
pub struct SameSeed(PerThread);

impl SameSeed {
    /// Creates a sampler that starts every thread with this seed and the same stream.
    pub fn new(seed: u64) -> Self {
        Self(PerThread::stepping(seed, 0))
    }
}

impl Sampler for SameSeed {
    fn pair(&self, at: Address) -> [f64; 2] {
        self.0.pair(at)
    }
}
