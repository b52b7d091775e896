//! AVX2: registers of 256 bits; a mask is a register whose lanes are all ones or all zeros.

#![expect(
    unsafe_code,
    reason = "instructions that not every processor has; `run` alone lets anyone near them, behind `is_available`"
)]

mod double;
mod single;

use super::pair::{HalfMask, Pair, PairMask};
use super::{Apart, Float, Mask, Precision, REVERSED, SWAPPED, SWAPPED_HALVES, SWAPPED_LOWER, Words, Work};
use double::F64x4;
use pathmark_tracer::math::Bits;
use single::F32x8;
use std::arch::x86_64 as x86;
use std::ops::Not;

instruction_set! {
    is_x86_feature_detected["avx2" "fma" "popcnt" "lzcnt" "bmi1" "bmi2"]: Pair<F64x4>, Pair<F32x8>;
    ask_for(address) = op!(x86::_mm_prefetch::<{ x86::_MM_HINT_T0 }>(address));
}

#[derive(Clone, Copy)]
pub(super) struct U64x4(x86::__m256i);

/// Eight words of 32 bits.
#[derive(Clone, Copy)]
pub(super) struct U32x8(x86::__m256i);

/// All ones or all zeros in each lane.
#[derive(Clone, Copy)]
pub(super) struct Mask4(x86::__m256d);

/// All ones or all zeros in each lane of a register of single precision.
#[derive(Clone, Copy)]
pub(super) struct Mask8(x86::__m256);

operator!(U64x4(x86): BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256);
operator!(U32x8(x86): BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256);
operator!(Mask4(x86): BitAnd bitand _mm256_and_pd, BitOr bitor _mm256_or_pd);
operator!(Mask8(x86): BitAnd bitand _mm256_and_ps, BitOr bitor _mm256_or_ps);

impl Not for Mask4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(op!(x86::_mm256_xor_pd(self.0, x86::_mm256_castsi256_pd(x86::_mm256_set1_epi64x(-1)))))
    }
}

/// Sixteen bytes, repeated in every half of a register.
#[inline(always)]
fn table(entries: &[i8; 16]) -> x86::__m256i {
    op!(x86::_mm256_broadcastsi128_si256(x86::_mm_loadu_si128(entries.as_ptr().cast())))
}

impl Bits for U64x4 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(x86::_mm256_set1_epi64x(word as i64)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(x86::_mm256_add_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // Long multiplication by halves; the product of the higher halves is beyond 64 bits.
        op!({
            let low = x86::_mm256_mul_epu32(self.0, other.0);
            let first = x86::_mm256_mul_epu32(x86::_mm256_srli_epi64::<32>(self.0), other.0);
            let second = x86::_mm256_mul_epu32(self.0, x86::_mm256_srli_epi64::<32>(other.0));
            let crossed = x86::_mm256_slli_epi64::<32>(x86::_mm256_add_epi64(first, second));
            Self(x86::_mm256_add_epi64(low, crossed))
        })
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        Self(op!(x86::_mm256_mul_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(x86::_mm256_sll_epi64(self.0, x86::_mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(x86::_mm256_srl_epi64(self.0, x86::_mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(x86::_mm256_srlv_epi64(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        Self(op!(x86::_mm256_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED))))
    }
    #[inline(always)]
    fn mirrored(self) -> Self {
        Self(op!(x86::_mm256_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED_LOWER))))
    }
}

/// Every byte with its bits in reverse order: half bytes by table.
#[inline(always)]
fn reversed_bytes(bytes: x86::__m256i) -> x86::__m256i {
    op!({
        let (low, high, nibble) = (table(&REVERSED[0]), table(&REVERSED[1]), x86::_mm256_set1_epi8(0x0F));
        let (a, b) =
            (x86::_mm256_and_si256(bytes, nibble), x86::_mm256_and_si256(x86::_mm256_srli_epi64::<4>(bytes), nibble));
        x86::_mm256_or_si256(x86::_mm256_shuffle_epi8(low, a), x86::_mm256_shuffle_epi8(high, b))
    })
}

impl Bits for U32x8 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(x86::_mm256_set1_epi32(word as i32)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(x86::_mm256_add_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        Self(op!(x86::_mm256_mullo_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        self.times(other)
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(x86::_mm256_sll_epi32(self.0, x86::_mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(x86::_mm256_srl_epi32(self.0, x86::_mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(x86::_mm256_srlv_epi32(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        Self(op!(x86::_mm256_shuffle_epi8(reversed_bytes(self.0), table(&SWAPPED_HALVES))))
    }
    #[inline(always)]
    fn mirrored(self) -> Self {
        self.reversed()
    }
}

impl Mask for Mask4 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        let each = U64x4(op!(x86::_mm256_setr_epi64x(1, 2, 4, 8)));
        let found = U64x4::splat(u64::from(bits)) & each;
        Self(op!(x86::_mm256_castsi256_pd(x86::_mm256_cmpeq_epi64(found.0, each.0))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        op!(x86::_mm256_movemask_pd(self.0)) as u32
    }
}

impl HalfMask for Mask4 {
    const LANES: u32 = 4;
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(op!(x86::_mm256_xor_ps(self.0, x86::_mm256_castsi256_ps(x86::_mm256_set1_epi32(-1)))))
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        op!({
            let each = x86::_mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            let found = x86::_mm256_and_si256(x86::_mm256_set1_epi32(bits as i32), each);
            Self(x86::_mm256_castsi256_ps(x86::_mm256_cmpeq_epi32(found, each)))
        })
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        op!(x86::_mm256_movemask_ps(self.0)) as u32
    }
}

impl HalfMask for Mask8 {
    const LANES: u32 = 8;
}

impl PairMask for Mask8 {
    type Half = Mask4;
    #[inline(always)]
    fn halves(self) -> Pair<Mask4> {
        op!({
            let both = x86::_mm256_castps_si256(self.0);
            let lower = x86::_mm256_cvtepi32_epi64(x86::_mm256_castsi256_si128(both));
            let upper = x86::_mm256_cvtepi32_epi64(x86::_mm256_extracti128_si256::<1>(both));
            Pair(Mask4(x86::_mm256_castsi256_pd(lower)), Mask4(x86::_mm256_castsi256_pd(upper)))
        })
    }
    #[inline(always)]
    fn of_halves(halves: Pair<Mask4>) -> Self {
        Self(op!(x86::_mm256_castsi256_ps(narrowed::<LOWER>(
            x86::_mm256_castpd_si256(halves.0.0),
            x86::_mm256_castpd_si256(halves.1.0)
        ))))
    }
}

/// The lower halves of words, and their upper halves, as an order of quarters.
const LOWER: i32 = 0b10_00_10_00;
const UPPER: i32 = 0b11_01_11_01;

/// The lower or the upper halves of eight words.
#[inline(always)]
fn narrowed<const HALVES: i32>(lower: x86::__m256i, upper: x86::__m256i) -> x86::__m256i {
    op!({
        let halves = x86::_mm256_shuffle_ps::<HALVES>(x86::_mm256_castsi256_ps(lower), x86::_mm256_castsi256_ps(upper));
        // The quarters are in the order lower, upper, lower, upper.
        x86::_mm256_permute4x64_epi64::<0b11_01_10_00>(x86::_mm256_castps_si256(halves))
    })
}

impl Words<Mask4> for U64x4 {
    #[inline(always)]
    fn load(from: &[u64]) -> Self {
        assert!(from.len() >= 4);
        Self(op!(x86::_mm256_loadu_si256(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn store(self, to: &mut [u64]) {
        assert!(to.len() >= 4);
        op!(x86::_mm256_storeu_si256(to.as_mut_ptr().cast(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask4, from: &[u64]) -> Self {
        Self::choose(mask, Self(spread(mask, Self::load(from).0)), self)
    }
    #[inline(always)]
    fn word(&self, lane: usize) -> u64 {
        let mut all = [0; 4];
        self.store(&mut all);
        all[lane]
    }
    #[inline(always)]
    fn set_word(&mut self, lane: usize, word: u64) {
        let mut all = [0; 4];
        self.store(&mut all);
        all[lane] = word;
        *self = Self::load(&all);
    }
    #[inline(always)]
    fn choose(mask: Mask4, yes: Self, no: Self) -> Self {
        Self(op!(x86::_mm256_blendv_epi8(no.0, yes.0, x86::_mm256_castpd_si256(mask.0))))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask4 {
        Mask4(op!(x86::_mm256_castsi256_pd(x86::_mm256_cmpgt_epi64(other.0, self.0))))
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask4 {
        Mask4(op!(x86::_mm256_castsi256_pd(x86::_mm256_cmpeq_epi64(self.0, other.0))))
    }
}

/// For each mask, the halves of words for its lanes: the first lane in the mask takes the first word, and so on.
const SPREAD: [[i32; 8]; 16] = {
    let (mut table, mut mask) = ([[0; 8]; 16], 0);
    while mask < 16 {
        let (mut lane, mut next) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 == 1 {
                table[mask][2 * lane] = 2 * next;
                table[mask][2 * lane + 1] = 2 * next + 1;
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// The lowest words, moved to the lanes of a mask in order.
#[inline(always)]
fn spread(mask: Mask4, words: x86::__m256i) -> x86::__m256i {
    let order = &SPREAD[mask.bits() as usize & 15];
    op!(x86::_mm256_permutevar8x32_epi32(words, x86::_mm256_loadu_si256(order.as_ptr().cast())))
}
