//! Two vectors as one: each operation runs on one, then on the other, so that the second's work hides the first's
//! latency.

use super::{Apart, Float, Mask, Table, Words};
use pathmark_tracer::math::{Bits, Real};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// The lower lanes and the upper ones.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pair<V>(pub(super) V, pub(super) V);

/// Operations on the lower lanes, then on the upper ones.
macro_rules! forward {
    ($($method:ident($($other:ident),*);)*) => {$(
        #[inline(always)]
        fn $method(self, $($other: Self),*) -> Self {
            Self(self.0.$method($($other.0),*), self.1.$method($($other.1),*))
        }
    )*};
}

/// Comparisons likewise.
macro_rules! compare {
    ($($method:ident)*) => {$(
        #[inline(always)]
        fn $method(self, other: Self) -> Self::Mask {
            Pair(self.0.$method(other.0), self.1.$method(other.1))
        }
    )*};
}

macro_rules! operators {
    ($($Trait:ident $method:ident($($other:ident)?);)*) => {$(
        // `Copy` types need no drop code: without `Copy` the compiler had to remove ten times as many branches from
        // each operation.
        impl<V: $Trait<Output = V> + Copy> $Trait for Pair<V> {
            type Output = Self;
            forward! { $method($($other)?); }
        }
    )*};
}

operators! {
    Add add(other);
    Sub sub(other);
    Mul mul(other);
    Div div(other);
    BitAnd bitand(other);
    BitOr bitor(other);
    BitXor bitxor(other);
    Neg neg();
    Not not();
}

impl<V: Real> Real for Pair<V> {
    type Mask = Pair<V::Mask>;
    const SIGNIFICAND: u32 = V::SIGNIFICAND;
    const SMALLEST: f64 = V::SMALLEST;

    forward! {
        sqrt();
        abs();
        times_plus(factor, addend);
        copysign(sign);
    }
    compare! { lt le }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(V::splat(value), V::splat(value))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(V::select(mask.0, yes.0, no.0), V::select(mask.1, yes.1, no.1))
    }
}

impl<B: Bits> Bits for Pair<B> {
    forward! {
        plus(other);
        times(other);
        times_low(other);
        down_by(count);
        reversed();
        mirrored();
    }
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(B::splat(word), B::splat(word))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(self.0.up::<N>(), self.1.up::<N>())
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(self.0.down::<N>(), self.1.down::<N>())
    }
}

/// Masks of two vectors; the lower vector has the lower bits.
impl<M: HalfMask> Mask for Pair<M> {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        Self(M::from_bits(bits), M::from_bits(bits >> M::LANES))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        M::bits_of_both(self.0, self.1)
    }
    #[inline(always)]
    fn any(self) -> bool {
        M::any_of_both(self.0, self.1)
    }
}

/// A mask with a fixed number of lanes.
pub(super) trait HalfMask: Mask {
    const LANES: u32;
    /// The bits of the mask of both vectors.
    #[inline(always)]
    fn bits_of_both(lower: Self, upper: Self) -> u32 {
        lower.bits() | upper.bits() << Self::LANES
    }
    /// Whether it holds in any lane of either.
    #[inline(always)]
    fn any_of_both(lower: Self, upper: Self) -> bool {
        Self::bits_of_both(lower, upper) != 0
    }
}

/// A pair is half of a pair of pairs.
impl<M: HalfMask> HalfMask for Pair<M> {
    const LANES: u32 = 2 * M::LANES;
}

/// A mask for the lanes of two registers of words.
pub(super) trait PairMask: Mask {
    /// The mask of one register.
    type Half: HalfMask;
    fn halves(self) -> Pair<Self::Half>;
    fn of_halves(halves: Pair<Self::Half>) -> Self;
}

impl<M: HalfMask> PairMask for Pair<M> {
    type Half = M;
    #[inline(always)]
    fn halves(self) -> Self {
        self
    }
    #[inline(always)]
    fn of_halves(halves: Self) -> Self {
        halves
    }
}

impl<M: PairMask, B: Words<M::Half>> Words<M> for Pair<B> {
    #[inline(always)]
    fn load(from: &[u64]) -> Self {
        let (lower, upper) = from.split_at(M::Half::LANES as usize);
        Self(B::load(lower), B::load(upper))
    }
    #[inline(always)]
    fn store(self, to: &mut [u64]) {
        let (lower, upper) = to.split_at_mut(M::Half::LANES as usize);
        self.0.store(lower);
        self.1.store(upper);
    }
    #[inline(always)]
    fn fill(self, mask: M, from: &[u64]) -> Self {
        let Pair(lower, upper) = mask.halves();
        let rest = &from[lower.bits().count_ones() as usize..];
        Self(self.0.fill(lower, from), self.1.fill(upper, rest))
    }
    #[inline(always)]
    fn word(&self, lane: usize) -> u64 {
        let lanes = M::Half::LANES as usize;
        if lane < lanes { self.0.word(lane) } else { self.1.word(lane - lanes) }
    }
    #[inline(always)]
    fn set_word(&mut self, lane: usize, word: u64) {
        let lanes = M::Half::LANES as usize;
        if lane < lanes { self.0.set_word(lane, word) } else { self.1.set_word(lane - lanes, word) }
    }
    #[inline(always)]
    fn choose(mask: M, yes: Self, no: Self) -> Self {
        let Pair(lower, upper) = mask.halves();
        Self(B::choose(lower, yes.0, no.0), B::choose(upper, yes.1, no.1))
    }
    #[inline(always)]
    fn less(self, other: Self) -> M {
        M::of_halves(Pair(self.0.less(other.0), self.1.less(other.1)))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> M {
        M::of_halves(Pair(self.0.equal(other.0), self.1.equal(other.1)))
    }
}

impl<V: Float<Mask: HalfMask>> Float for Pair<V> {
    type Bits = Pair<V::Bits>;
    type Digits = Pair<V::Digits>;
    type One = V::One;
    type Single = V::Single;
    type Register = V;
    const LANES: usize = 2 * V::LANES;

    forward! {
        larger(other);
        smaller(other);
        at_least(other);
        at_most(other);
        about_times_plus(factor, addend);
        sooner(other);
        later(other);
    }
    compare! { equal is_sooner }
    #[inline(always)]
    fn load(from: &[V::One]) -> Self {
        let (lower, upper) = from.split_at(V::LANES);
        Self(V::load(lower), V::load(upper))
    }
    #[inline(always)]
    fn store(self, to: &mut [V::One]) {
        let (lower, upper) = to.split_at_mut(V::LANES);
        self.0.store(lower);
        self.1.store(upper);
    }
    #[inline(always)]
    fn fill(self, mask: Self::Mask, from: &[V::One]) -> Self {
        let upper = &from[mask.0.bits().count_ones() as usize..];
        Self(self.0.fill(mask.0, from), self.1.fill(mask.1, upper))
    }
    #[inline(always)]
    fn one(value: f64) -> V::One {
        V::one(value)
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        if lane < V::LANES { self.0.lane(lane) } else { self.1.lane(lane - V::LANES) }
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        if lane < V::LANES { self.0.set_lane(lane, value) } else { self.1.set_lane(lane - V::LANES, value) }
    }
    #[inline(always)]
    fn least(self) -> f64 {
        self.0.smaller(self.1).least()
    }
    #[inline(always)]
    fn ahead(near: Self, far: Self) -> Self {
        Self(V::ahead(near.0, far.0), V::ahead(near.1, far.1))
    }
    #[inline(always)]
    fn number(bits: Self::Bits) -> Self {
        Self(V::number(bits.0), V::number(bits.1))
    }
    #[inline(always)]
    fn unit(bits: Self::Bits) -> Self {
        Self(V::unit(bits.0), V::unit(bits.1))
    }
    #[inline(always)]
    fn halves(bits: Self::Bits) -> [Self::Digits; 2] {
        let ([a, b], [c, d]) = (V::halves(bits.0), V::halves(bits.1));
        [Pair(a, c), Pair(b, d)]
    }
    #[inline(always)]
    fn choose_digits(mask: Self::Mask, yes: Self::Digits, no: Self::Digits) -> Self::Digits {
        Pair(V::choose_digits(mask.0, yes.0, no.0), V::choose_digits(mask.1, yes.1, no.1))
    }
    #[inline(always)]
    fn fraction(digits: Self::Digits) -> Self {
        Self(V::fraction(digits.0), V::fraction(digits.1))
    }
    #[inline(always)]
    fn ask_for(address: *const i8) {
        V::ask_for(address);
    }
    #[inline(always)]
    fn apart<W: Apart>(work: W) -> W::Output {
        V::apart(work)
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        let ([a, b, c, d], [e, f, g, h]) = (V::rows(table, rows.0), V::rows(table, rows.1));
        [Self(a, e), Self(b, f), Self(c, g), Self(d, h)]
    }
}
