//! One generator for all threads without a lock: `--sampler racy`, wrong on purpose.
//!
//! A number is three steps: read the state, step on, write it back. If two threads read before either writes, both draw the
//! same number and one step is lost; a thread that pauses between its read and its write takes all others back to its state.
//! In C this is undefined behaviour; here each access is atomic, so it is only wrong. It also costs time, because each write
//! takes the cache line from the other processors. The right way is `padded`.

use super::{Address, Sampler, mix};
use crate::math::unit;
use std::sync::atomic::{AtomicU64, Ordering};

/// The distance of two states of `SplitMix64`, whose output is [`mix`] of its state.
pub(super) const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// The sampler: the state of one `SplitMix64` (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", 2014).
#[derive(Debug)]
pub struct Racy(AtomicU64);

impl Racy {
    /// Creates a generator that all threads share.
    pub fn new(seed: u64) -> Self {
        Self(AtomicU64::new(mix(seed)))
    }
}

/// The next number of a `SplitMix64` whose state is read and written in two steps.
pub(super) fn next(state: &AtomicU64) -> f64 {
    let old = state.load(Ordering::Relaxed);
    state.store(old.wrapping_add(STEP), Ordering::Relaxed);
    unit(mix(old))
}

impl Sampler for Racy {
    fn pair(&self, _: Address) -> [f64; 2] {
        [(); 2].map(|()| next(&self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first numbers of the authors' generator from the state 1234567, as Rosetta Code's task about `SplitMix64` lists them.
    #[test]
    fn one_thread_draws_the_numbers_of_splitmix64() {
        let state = AtomicU64::new(1_234_567);
        for expected in [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423] {
            assert_eq!(next(&state), unit(expected));
        }
    }
}
