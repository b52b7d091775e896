//! Uniform numbers from one hash of the address: `--sampler hash`.
//!
//! `independent` starts a generator with a key that is uniform itself: mixed from seed, pixel and sample, and mixed
//! again with the use. This sampler makes the pair from that key directly, with two multiplications instead of six. No
//! two uses of a sample and no two samples in a use have the same word, because a mix is a bijection (see
//! `independent`). Two different uses of two different samples have the same word with probability 2^-64.
//!
//! Two numbers need 106 bits, but a word has 64: the second number is the first with its halves swapped. So they are
//! independent down to 2^-32, which is finer than single precision resolves. Below that, one number follows from the
//! other.

use super::independent::{mix, path};
use super::{Address, Sampler};
use crate::math::{Bits, unit};

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hash;

/// A word, and the same word with its halves swapped.
#[inline(always)]
pub fn both<B: Bits>(word: B) -> [B; 2] {
    [word, word.up::<32>() | word.down::<32>()]
}

impl Sampler for Hash {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // Constant along a path, so the compiler moves it out of the loop over bounces.
        let path = path(at.key.seed, u64::from(at.key.pixel) << 32 | u64::from(at.key.sample));
        both(mix(path ^ dimension)).map(unit)
    }
}
