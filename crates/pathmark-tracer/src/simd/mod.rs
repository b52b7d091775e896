//! Numbers side by side in the registers of a processor: the same formulas as for one number, over more of them at once.
//!
//! One instruction set a folder or file; this file is their table. What the processor has is found out at run time, so the program needs no build flags
//! and runs anywhere. Every level gives the same bits, lane by lane: each operation is one that IEEE 754 rounds exactly, fused are those that
//! [`Real::times_plus`] says, and there are no estimates.
//!
//! To add an instruction set: write its file with types that implement [`Float`] and [`Words`], and a line in `levels!` below.

/// Half bytes with their bits in reverse order, in the upper half of a byte and in the lower, and the bytes of two words in reverse order:
/// what turns words round on processors that shuffle bytes by a table.
#[cfg(target_arch = "x86_64")]
const REVERSED: [[i8; 16]; 3] = [
    [0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16],
    [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15],
    [7, 6, 5, 4, 3, 2, 1, 0, 15, 14, 13, 12, 11, 10, 9, 8],
];

/// Whether the processor counts bits by an instruction, as all do that have AVX2. It does not follow from AVX2 for the compiler, and lanes of a mask are
/// counted often.
#[cfg(target_arch = "x86_64")]
fn has_bit_counts() -> bool {
    is_x86_feature_detected!("popcnt")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
}

#[cfg(target_arch = "x86_64")]
#[macro_use]
mod register;

mod aligned;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod plain;
mod table;
#[cfg(test)]
mod tests;
#[cfg(target_arch = "x86_64")]
mod two;

use crate::math::{Bits, Real};
pub use aligned::Aligned;
use std::ops::{BitAnd, BitOr, Not};
pub use table::{Column, Number, Numbers, Table};

/// The answers of a comparison, one bit a lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// From bits, the lowest for lane 0; those beyond the last lane are not looked at.
    fn from_bits(bits: u32) -> Self;
    /// To bits; none is set beyond the last lane.
    fn bits(self) -> u32;
    /// Whether it holds in a lane.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// As many words of 64 bits as a mask has lanes.
pub trait Words<M>: Bits {
    /// From at least as many words as there are lanes.
    fn load(from: &[u64]) -> Self;
    /// To at least as many words as there are lanes.
    fn store(self, to: &mut [u64]);
    /// `self`, but where the mask holds the next of the words, in order; there must be as many as there are lanes.
    #[must_use]
    fn fill(self, mask: M, from: &[u64]) -> Self;
    /// The word in a lane.
    fn word(&self, lane: usize) -> u64;
    /// Puts a word into a lane.
    fn set_word(&mut self, lane: usize, word: u64);
    /// `yes` where the mask holds, `no` elsewhere.
    #[must_use]
    fn choose(mask: M, yes: Self, no: Self) -> Self;
    /// Whether words below 2^63 are less than others.
    fn less(self, other: Self) -> M;
    /// Whether words are equal.
    fn equal(self, other: Self) -> M;
}

/// Numbers in lanes, at most [`MOST_LANES`] of them.
pub trait Float: Real<Mask: Mask> + Send + Sync + 'static {
    /// As many words of 64 bits.
    type Bits: Words<Self::Mask>;
    /// One of the numbers.
    type One: Number;
    /// What one register of the same instruction set holds in single precision.
    type Single: Float<One = f32>;
    /// What one register holds of such numbers.
    type Register: Float<One = Self::One>;
    /// How many there are.
    const LANES: usize;

    /// From at least as many numbers as there are lanes.
    fn load(from: &[Self::One]) -> Self;
    /// To at least as many numbers as there are lanes.
    fn store(self, to: &mut [Self::One]);
    /// `self`, but where the mask holds the next of the numbers, in order; there must be as many as there are lanes.
    #[must_use]
    fn fill(self, mask: Self::Mask, from: &[Self::One]) -> Self;
    /// Stores the numbers where the mask holds, in order. There must be room for as many as there are lanes; what is behind them may change.
    #[inline(always)]
    fn pack(self, mask: Self::Mask, to: &mut [Self::One]) {
        let mut all = [Self::One::default(); MOST_LANES];
        self.store(&mut all);
        let bits = mask.bits();
        let mut next = 0;
        for (lane, number) in all.iter().enumerate().take(Self::LANES) {
            to[next] = *number;
            next += (bits >> lane & 1) as usize;
        }
    }
    /// A number, rounded if need be.
    fn one(value: f64) -> Self::One;
    /// The number in a lane.
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
    /// The least of the numbers, none of which may be NaN.
    #[inline(always)]
    fn least(self) -> f64 {
        let mut all = [Self::One::default(); MOST_LANES];
        self.store(&mut all);
        all[..Self::LANES].iter().fold(f64::INFINITY, |least, number| least.min((*number).into()))
    }
    /// `self * factor + addend`, rounded once or twice, as the processor does it faster: only for what is made sure of by other means, or
    /// processors would differ.
    #[must_use]
    #[inline(always)]
    fn about_times_plus(self, factor: Self, addend: Self) -> Self {
        self.times_plus(factor, addend)
    }
    /// The first of two distances along a ray, the nearer and the farther, that is not behind its start: not negative and not NaN. If both are, it
    /// is one that no other is [`Float::sooner`] than.
    #[must_use]
    #[inline(always)]
    fn ahead(near: Self, far: Self) -> Self {
        let (zero, never) = (Self::splat(0.0), Self::splat(f64::INFINITY));
        Self::select(zero.le(near), near, Self::select(zero.le(far), far, never))
    }
    /// The sooner of two distances ahead; infinity is sooner than none.
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
    /// The leading bits of a word as a number in [0, 1), as many as a number has digits: exact, and never 1.
    fn unit(bits: Self::Bits) -> Self;
    /// Asks for the memory at an address, which need not be one.
    #[inline(always)]
    fn ask_for(_address: *const i8) {}
    /// Does some work in a function of its own, which is compiled once for all that call it: what takes so long that a call is nothing beside it
    /// need not be part of each of them.
    fn apart<W: Apart>(work: W) -> W::Output;
    /// Rows of a table by their numbers, turned so that lane k of result j is `table[rows[k]][j]`. Numbers must be whole and in the table.
    fn rows(table: &Table, rows: Self) -> [Self; 4];
}

/// Asks for what will soon be loaded, so many from a place on; what is not there is not asked for. It changes nothing but the time.
#[inline(always)]
pub fn prefetch<V: Float, T>(from: &[T], place: usize, count: usize) {
    let start = from.as_ptr().wrapping_add(place).cast::<i8>();
    for line in 0..(count * size_of::<T>()).div_ceil(LINE) {
        V::ask_for(start.wrapping_add(LINE * line));
    }
}

/// Bytes that come from memory together.
const LINE: usize = 64;

/// The most lanes that any level has: masks are words of 32 bits.
pub const MOST_LANES: usize = 32;

/// What runs on a level: a function that is compiled once for each.
pub trait Work {
    /// Whether other work gives the same and this is only faster. A level that is a last resort ([`Level::is_fallback`]) is not compiled for it.
    const IS_SHORTCUT: bool = false;
    /// What it returns.
    type Output;
    /// Does it. Everything that it calls must be `#[inline(always)]`, or it is compiled without the
    /// instructions of the level.
    fn run<V: Float>(self) -> Self::Output;
}

/// What a function of its own does with the instructions of a level.
pub trait Apart {
    /// What it returns.
    type Output;
    /// Does it; the same holds as for [`Work::run`].
    fn run(self) -> Self::Output;
}

/// The floating-point format of numbers in lanes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Double: 53 digits.
    F64,
    /// Single: 24 digits.
    F32,
}

impl Precision {
    /// All of them, the default first.
    pub const ALL: [Self; 2] = [Self::F64, Self::F32];

    /// Its name on the command line, in CSV and TOML.
    pub const fn name(self) -> &'static str {
        match self {
            Self::F64 => "f64",
            Self::F32 => "f32",
        }
    }
}

/// One line of the table of levels.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    set: Set,
    pub is_available: fn() -> bool,
}

impl Entry {
    /// The level, if this processor has it.
    pub fn here(&'static self) -> Option<Level> {
        (self.is_available)().then_some(Level(self))
    }
}

/// A level that this processor has: only [`Entry::here`] makes one.
#[derive(Debug, Clone, Copy)]
pub struct Level(&'static Entry);

impl Level {
    /// Its name.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// Whether it is for processors alone that have none of the others: [`Work::IS_SHORTCUT`].
    pub fn is_fallback(self) -> bool {
        plain::IS_FALLBACK && matches!(self.0.set, Set::Baseline)
    }
}

macro_rules! levels {
    ($($(#[$attribute:meta])* $Set:ident: $name:literal, $about:literal => $module:ident;)*) => {
        #[derive(Debug, Clone, Copy)]
        enum Set { $($(#[$attribute])* $Set),* }

        /// The table of levels, the fastest first; the last one is everywhere.
        pub const LEVELS: &[Entry] = &[$(
            $(#[$attribute])*
            Entry { name: $name, about: $about, set: Set::$Set, is_available: $module::is_available },
        )*];

        /// Does some work on a level.
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
    Baseline: "baseline", "what the compiler makes of small arrays: SSE2 or NEON" => plain;
}

struct OfLevel;

impl Work for OfLevel {
    type Output = Sizes;

    fn run<V: Float>(self) -> Sizes {
        Sizes { lanes: V::LANES, register: V::Register::LANES, single: V::Single::LANES }
    }
}

/// How many numbers a level has side by side.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// In all.
    pub lanes: usize,
    /// In one register.
    pub register: usize,
    /// In one register of single precision.
    pub single: usize,
}

/// How many numbers a level has side by side.
pub fn sizes_of(level: Level, precision: Precision) -> Sizes {
    on_level(level, precision, OfLevel)
}

/// The levels of this processor, the fastest first.
pub fn levels() -> impl Iterator<Item = Level> + Clone {
    LEVELS.iter().filter_map(Entry::here)
}
