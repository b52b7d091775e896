//! Uniform numbers from one hash of the address: `--sampler hash`.
//!
//! The key with which `independent` starts a generator is uniform itself: mixed from seed, pixel and sample, and mixed again with the use. Here
//! it is what a pair is made of, at two multiplications instead of six. No two uses of a sample and no two samples in a use have the same
//! word, because a mix is a bijection (see `independent`); a use of one sample has the word of another use of another by a chance of 2^-64.
//!
//! A number has 53 digits, two of them 106, and a word 64: the second number is the first with its halves changed round. So they are
//! independent down to 2^-32, as far as single precision and more could tell, and below that one follows from the other.

use super::independent::{mix, path};
use super::{Address, Sampler};
use crate::math::{Bits, unit};

/// The sampler; it has no state.
#[derive(Debug, Clone, Copy, Default)]
pub struct Hash;

/// A word, and with its halves changed round.
#[inline(always)]
pub(super) fn both<B: Bits>(word: B) -> [B; 2] {
    [word, word.up::<32>() | word.down::<32>()]
}

impl Sampler for Hash {
    #[inline(always)]
    fn pair(&self, at: Address) -> [f64; 2] {
        let dimension = u64::from(at.bounce) << 32 | u64::from(at.branch) << 16 | at.purpose as u64;
        // The same for a whole path, so a compiler takes it out of the loop over bounces.
        let path = path(at.key.seed, u64::from(at.key.pixel) << 32 | u64::from(at.key.sample));
        both(mix(path ^ dimension)).map(unit)
    }
}
