//! One PCG32 generator behind a lock: `--sampler locked`.
//!
//! The simplest way to make a program's single generator safe for threads. As with the C library's `rand`, threads wait
//! for each other, and no two runs with more than one thread are alike. This sampler exists to be measured, not to be
//! used.

use super::{Address, Sampler};
use crate::math::unit;
use rand::Rng;
use rand_pcg::Pcg32;
use std::sync::{Mutex, PoisonError};

#[derive(Debug)]
pub struct Locked(Mutex<Pcg32>);

impl Locked {
    /// Creates a generator that all threads share.
    pub fn new(seed: u64) -> Self {
        Self(Mutex::new(Pcg32::new(seed, 0)))
    }
}

impl Sampler for Locked {
    fn pair(&self, _: Address) -> [f64; 2] {
        // Each number locks by itself, as a call of `rand()` does.
        [(); 2].map(|()| unit(self.0.lock().unwrap_or_else(PoisonError::into_inner).next_u64()))
    }
}
