//! Numbers side by side in the registers of a processor: the same formulas as for one number, for several at once.
//!
//! Each instruction set has a folder or a file; this file has their table. The processor's instruction sets are
//! detected at run time, so the program needs no build flags and runs anywhere. Every instruction set gives the same
//! bits, lane by lane: IEEE 754 rounds each operation exactly, only the operations that [`Real::times_plus`] names are
//! fused, and there are no estimates.
//!
//! To add an instruction set: write its file with types that implement [`Float`] and [`Words`], and a line in
//! `levels!`.

/// Half bytes with reversed bits, in the upper half of a byte and in the lower, for processors that shuffle bytes by a
/// table.
#[cfg(target_arch = "x86_64")]
const REVERSED: [[i8; 16]; 2] = [
    [0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16],
    [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15],
];

/// The bytes of two words in reverse order.
#[cfg(target_arch = "x86_64")]
const SWAPPED: [i8; 16] = [7, 6, 5, 4, 3, 2, 1, 0, 15, 14, 13, 12, 11, 10, 9, 8];

/// The bytes of the lower halves of two words in reverse order, and zeros in place of the upper halves.
#[cfg(target_arch = "x86_64")]
const SWAPPED_LOWER: [i8; 16] = [3, 2, 1, 0, -1, -1, -1, -1, 11, 10, 9, 8, -1, -1, -1, -1];

/// The bytes of four words of 32 bits in reverse order.
#[cfg(target_arch = "x86_64")]
const SWAPPED_HALVES: [i8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];

// A compiler for one kind of processor has no instructions of the others.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
#[macro_use]
mod register;

mod aligned;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod pair;
mod portable;
mod table;
#[cfg(test)]
mod tests;

pub use aligned::Aligned;
pub use pathmark_tracer::math::Precision;
use pathmark_tracer::math::{Bits, Real};
use std::ops::{BitAnd, BitOr, Not};
pub use table::{Column, Number, Numbers, Table};

/// The result of a comparison, one bit per lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// From bits, the lowest for lane 0; bits beyond the last lane are ignored.
    fn from_bits(bits: u32) -> Self;
    /// To bits; no bit is set beyond the last lane.
    fn bits(self) -> u32;
    /// Whether it holds in any lane.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// Words of 64 bits, as many as a mask has lanes.
pub trait Words<M>: Bits {
    /// From at least as many words as there are lanes.
    fn load(from: &[u64]) -> Self;
    /// To at least as many words as there are lanes.
    fn store(self, to: &mut [u64]);
    /// `self`, but lanes in the mask get the next of the words, in order. There must be as many words as lanes.
    #[must_use]
    fn fill(self, mask: M, from: &[u64]) -> Self;
    fn word(&self, lane: usize) -> u64;
    /// Puts a word into a lane.
    fn set_word(&mut self, lane: usize, word: u64);
    /// `yes` where the mask holds, `no` elsewhere.
    #[must_use]
    fn choose(mask: M, yes: Self, no: Self) -> Self;
    /// Whether words are less than others, for words below 2^63.
    fn less(self, other: Self) -> M;
    fn equal(self, other: Self) -> M;
}

/// Numbers in lanes, at most [`MOST_LANES`] of them.
pub trait Float: Real<Mask: Mask> + Send + Sync + 'static {
    /// Words of 64 bits, as many as there are numbers.
    type Bits: Words<Self::Mask>;
    /// As many words of 32 bits, or of 64 if a number takes more than 32 digits or the processor has no such registers.
    type Digits: Bits;
    type One: Number;
    /// One register of the same instruction set in single precision.
    type Single: Float<One = f32>;
    /// One register of these numbers.
    type Register: Float<One = Self::One>;
    const LANES: usize;

    /// From at least as many numbers as there are lanes.
    fn load(from: &[Self::One]) -> Self;
    /// To at least as many numbers as there are lanes.
    fn store(self, to: &mut [Self::One]);
    /// `self`, but lanes in the mask get the next of the numbers, in order. There must be as many numbers as lanes.
    #[must_use]
    fn fill(self, mask: Self::Mask, from: &[Self::One]) -> Self;
    /// A number, rounded if need be.
    fn one(value: f64) -> Self::One;
    fn lane(&self, lane: usize) -> f64;
    /// Puts a number, rounded if need be, into a lane.
    fn set_lane(&mut self, lane: usize, value: f64);
    /// `self == other`; false if either is NaN.
    fn equal(self, other: Self) -> Self::Mask;
    /// The larger number; `other` if either is NaN.
    #[must_use]
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// The smaller number; `other` if either is NaN.
    #[must_use]
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// The larger number, `other` if this one is NaN; `other` may not be NaN. Of two zeros it may be either.
    #[must_use]
    #[inline(always)]
    fn at_least(self, other: Self) -> Self {
        self.larger(other)
    }
    /// The smaller number likewise.
    #[must_use]
    #[inline(always)]
    fn at_most(self, other: Self) -> Self {
        self.smaller(other)
    }
    /// The least of the numbers, none of which may be NaN.
    #[inline(always)]
    fn least(self) -> f64 {
        let mut all = [Self::One::default(); MOST_LANES];
        self.store(&mut all);
        all[..Self::LANES].iter().fold(f64::INFINITY, |least, number| least.min((*number).into()))
    }
    /// `self * factor + addend`, rounded once or twice, whichever is faster on the processor. Only for values whose
    /// effect is checked by other means; otherwise processors would differ.
    #[must_use]
    #[inline(always)]
    fn about_times_plus(self, factor: Self, addend: Self) -> Self {
        self.times_plus(factor, addend)
    }
    /// The first of two distances along a ray, the nearer and the farther, that is not behind the ray's start: not
    /// negative and not NaN. If both are, there is none, and the result is not [`Float::sooner`] than any other.
    #[must_use]
    #[inline(always)]
    fn ahead(near: Self, far: Self) -> Self {
        let (zero, never) = (Self::splat(0.0), Self::splat(f64::INFINITY));
        Self::select(zero.le(near), near, Self::select(zero.le(far), far, never))
    }
    /// The sooner of two distances ahead; a missing distance is never sooner than infinity.
    #[must_use]
    #[inline(always)]
    fn sooner(self, other: Self) -> Self {
        Self::select(self.is_sooner(other), self, other)
    }
    /// The later of two distances ahead.
    #[must_use]
    #[inline(always)]
    fn later(self, other: Self) -> Self {
        Self::select(self.is_sooner(other), other, self)
    }
    /// Whether a distance ahead is less than another.
    #[inline(always)]
    fn is_sooner(self, other: Self) -> Self::Mask {
        self.lt(other)
    }
    /// Words below 2^53 as numbers, rounded if need be.
    fn number(bits: Self::Bits) -> Self;
    /// The leading bits of a word as a number in [0, 1), as many as the significand has digits: exact, and never 1.
    fn unit(bits: Self::Bits) -> Self;
    /// The lower halves of words and their upper halves, each in the lower 32 bits.
    fn halves(bits: Self::Bits) -> [Self::Digits; 2];
    /// `yes` where the mask holds, `no` elsewhere.
    #[must_use]
    fn choose_digits(mask: Self::Mask, yes: Self::Digits, no: Self::Digits) -> Self::Digits;
    /// Binary digits, the first in the lowest bit, as a number in [0, 1): as many digits as the significand has.
    fn fraction(digits: Self::Digits) -> Self;
    /// Prefetches the memory at an address, which need not be valid.
    #[inline(always)]
    fn ask_for(_address: *const i8) {}
    /// Runs work in a separate function, which is compiled once for all its callers. Work that takes much longer than a
    /// call need not be compiled into each of them.
    fn apart<W: Apart>(work: W) -> W::Output;
    /// Rows of a table by their numbers, transposed so that lane k of result j is `table[rows[k]][j]`. Numbers must be
    /// whole and in the table.
    fn rows(table: &Table, rows: Self) -> [Self; 4];
}

/// Prefetches `count` elements from `place` on, which may lie beyond the end. It changes nothing but the time.
#[inline(always)]
pub fn prefetch<V: Float, T>(from: &[T], place: usize, count: usize) {
    let start = from.as_ptr().wrapping_add(place).cast::<i8>();
    for line in 0..(count * size_of::<T>()).div_ceil(LINE) {
        V::ask_for(start.wrapping_add(LINE * line));
    }
}

/// Bytes of a cache line, which memory delivers together.
const LINE: usize = 64;

/// The most lanes of any instruction set: masks are words of 32 bits.
pub const MOST_LANES: usize = 32;

/// Work that is compiled once for each instruction set.
pub trait Work {
    /// Whether other work gives the same result, only more slowly. A fallback ([`Level::is_fallback`]) is not compiled
    /// for it.
    const IS_SHORTCUT: bool = false;
    type Output;
    /// Runs the work. Everything that it calls must be `#[inline(always)]`; otherwise it is compiled without the
    /// instructions of the set.
    fn run<V: Float>(self) -> Self::Output;
}

/// Work that runs in a separate function with the instructions of the set.
pub trait Apart {
    type Output;
    /// Runs the work; the same holds as for [`Work::run`].
    fn run(self) -> Self::Output;
}

/// One line of the table of instruction sets.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    set: Set,
    pub(crate) is_available: fn() -> bool,
}

impl Entry {
    /// The instruction set, if this processor has it.
    pub fn here(&'static self) -> Option<Level> {
        (self.is_available)().then_some(Level(self))
    }
}

/// An instruction set that this processor has: only [`Entry::here`] makes one.
#[derive(Debug, Clone, Copy)]
pub struct Level(&'static Entry);

impl Level {
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// Whether it is only for processors that have none of the others; see [`Work::IS_SHORTCUT`].
    pub fn is_fallback(self) -> bool {
        portable::IS_FALLBACK && matches!(self.0.set, Set::Baseline)
    }
}

macro_rules! levels {
    ($($(#[$attribute:meta])* $Set:ident: $name:literal, $about:literal => $module:ident;)*) => {
        #[derive(Debug, Clone, Copy)]
        enum Set { $($(#[$attribute])* $Set),* }

        /// The table of instruction sets, the fastest first. Every processor has the last one.
        pub const LEVELS: &[Entry] = &[$(
            $(#[$attribute])*
            Entry { name: $name, about: $about, set: Set::$Set, is_available: $module::is_available },
        )*];

        /// Runs work with an instruction set.
        pub fn on_level<W: Work>(level: Level, precision: Precision, work: W) -> W::Output {
            match level.0.set {
                $($(#[$attribute])* Set::$Set => $module::run(precision, work)),*
            }
        }
    };
}

levels! {
    #[cfg(target_arch = "x86_64")]
    Avx512: "avx512", "AVX-512 (F, DQ, VL, BW): 512-bit registers, two at a time" => avx512;
    #[cfg(target_arch = "x86_64")]
    Avx2: "avx2", "AVX2 and FMA: 256-bit registers, two at a time" => avx2;
    #[cfg(target_arch = "aarch64")]
    Neon: "neon", "NEON: 128-bit registers, two at a time" => neon;
    Baseline: "baseline", "small arrays that the compiler vectorises: SSE2 or NEON" => portable;
}

struct OfLevel;

impl Work for OfLevel {
    type Output = Sizes;

    fn run<V: Float>(self) -> Sizes {
        Sizes { lanes: V::LANES, register: V::Register::LANES, single: V::Single::LANES }
    }
}

/// Lane counts of an instruction set.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// Of all registers together.
    pub lanes: usize,
    pub register: usize,
    /// Of one register in single precision.
    pub single: usize,
}

/// The lane counts of an instruction set.
pub fn sizes_of(level: Level, precision: Precision) -> Sizes {
    on_level(level, precision, OfLevel)
}

/// The instruction sets of this processor, the fastest first.
pub fn levels() -> impl Iterator<Item = Level> + Clone {
    LEVELS.iter().filter_map(Entry::here)
}
