//! AVX2: four numbers in a register; a mask is a register whose lanes are all ones or all zeros.

#![expect(
    unsafe_code,
    reason = "instructions that not every processor has; `run` alone lets anyone near them, behind `is_available`"
)]

use super::two::{HalfMask, Two};
use super::{Float, Mask, Table, Work};
use crate::math::{Bits, Real};
use std::arch::x86_64::{
    __m256d, __m256i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm_cvtsi64_si128, _mm_loadu_si128, _mm256_add_epi64,
    _mm256_add_pd, _mm256_and_pd, _mm256_and_si256, _mm256_andnot_pd, _mm256_blend_epi32, _mm256_blendv_epi8,
    _mm256_blendv_pd, _mm256_broadcastsi128_si256, _mm256_castpd_si256, _mm256_castsi256_pd, _mm256_cmp_pd,
    _mm256_cmpeq_epi64, _mm256_cmpgt_epi64, _mm256_div_pd, _mm256_loadu_pd, _mm256_loadu_si256, _mm256_movemask_pd,
    _mm256_mul_epu32, _mm256_mul_pd, _mm256_or_pd, _mm256_or_si256, _mm256_permute2f128_pd,
    _mm256_permutevar8x32_epi32, _mm256_set1_epi64x, _mm256_set1_pd, _mm256_setr_epi64x, _mm256_shuffle_epi8,
    _mm256_sll_epi64, _mm256_slli_epi64, _mm256_sqrt_pd, _mm256_srl_epi64, _mm256_srli_epi64, _mm256_srlv_epi64,
    _mm256_storeu_pd, _mm256_storeu_si256, _mm256_sub_pd, _mm256_unpackhi_pd, _mm256_unpacklo_pd, _mm256_xor_pd,
    _mm256_xor_si256,
};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// Whether this processor has what is used here.
pub(super) fn is_available() -> bool {
    is_x86_feature_detected!("avx2")
}

/// Does the work; `None` if this processor cannot.
pub(super) fn run<W: Work>(work: W) -> Option<W::Output> {
    // SAFETY: the feature has been found a line above.
    is_available().then(|| unsafe { enter(work) })
}

#[target_feature(enable = "avx2")]
fn enter<W: Work>(work: W) -> W::Output {
    work.run::<Two<F64x4>>()
}

#[derive(Clone, Copy)]
pub(super) struct F64x4(__m256d);

#[derive(Clone, Copy)]
pub(super) struct U64x4(__m256i);

#[derive(Clone, Copy)]
pub(super) struct Mask4(__m256d);

operator!(F64x4: Add add _mm256_add_pd, Sub sub _mm256_sub_pd, Mul mul _mm256_mul_pd, Div div _mm256_div_pd);
operator!(U64x4: BitAnd bitand _mm256_and_si256, BitOr bitor _mm256_or_si256, BitXor bitxor _mm256_xor_si256);
operator!(Mask4: BitAnd bitand _mm256_and_pd, BitOr bitor _mm256_or_pd);

impl Neg for F64x4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(op!(_mm256_xor_pd(self.0, _mm256_set1_pd(-0.0))))
    }
}

impl Not for Mask4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(op!(_mm256_xor_pd(self.0, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)))))
    }
}

impl Real for F64x4 {
    type Mask = Mask4;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(op!(_mm256_set1_pd(value)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(op!(_mm256_sqrt_pd(self.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(op!(_mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let bit = op!(_mm256_and_pd(_mm256_set1_pd(-0.0), sign.0));
        Self(op!(_mm256_or_pd(self.abs().0, bit)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask4, yes: Self, no: Self) -> Self {
        Self(op!(_mm256_blendv_pd(no.0, yes.0, mask.0)))
    }
}

/// Sixteen bytes, in every half of a register.
#[inline(always)]
fn table(entries: &[i8; 16]) -> __m256i {
    op!(_mm256_broadcastsi128_si256(_mm_loadu_si128(entries.as_ptr().cast())))
}

impl Bits for U64x4 {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self(op!(_mm256_set1_epi64x(word as i64)))
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        Self(op!(_mm256_add_epi64(self.0, other.0)))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        // By halves, as on paper; the product of the higher ones is beyond 64 bits.
        op!({
            let low = _mm256_mul_epu32(self.0, other.0);
            let first = _mm256_mul_epu32(_mm256_srli_epi64::<32>(self.0), other.0);
            let second = _mm256_mul_epu32(self.0, _mm256_srli_epi64::<32>(other.0));
            let crossed = _mm256_slli_epi64::<32>(_mm256_add_epi64(first, second));
            Self(_mm256_add_epi64(low, crossed))
        })
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        Self(op!(_mm256_sll_epi64(self.0, _mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        Self(op!(_mm256_srl_epi64(self.0, _mm_cvtsi64_si128(i64::from(N)))))
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        Self(op!(_mm256_srlv_epi64(self.0, count.0)))
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        // Half bytes by table, then bytes by shuffle.
        let low = table(&[0, -128, 64, -64, 32, -96, 96, -32, 16, -112, 80, -48, 48, -80, 112, -16]);
        let high = table(&[0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15]);
        let swap = table(&[7, 6, 5, 4, 3, 2, 1, 0, 15, 14, 13, 12, 11, 10, 9, 8]);
        let nibble = Self::splat(0x0F0F_0F0F_0F0F_0F0F);
        let (a, b) = ((self & nibble).0, (self.down::<4>() & nibble).0);
        let bytes = op!(_mm256_or_si256(_mm256_shuffle_epi8(low, a), _mm256_shuffle_epi8(high, b)));
        Self(op!(_mm256_shuffle_epi8(bytes, swap)))
    }
}

impl Mask for Mask4 {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        let each = U64x4(op!(_mm256_setr_epi64x(1, 2, 4, 8)));
        let found = U64x4::splat(u64::from(bits)) & each;
        Self(op!(_mm256_castsi256_pd(_mm256_cmpeq_epi64(found.0, each.0))))
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        op!(_mm256_movemask_pd(self.0)) as u32
    }
}

impl HalfMask for Mask4 {
    const LANES: u32 = 4;
}

impl Float for F64x4 {
    type Bits = U64x4;
    const LANES: usize = 4;

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        assert!(from.len() >= 4);
        Self(op!(_mm256_loadu_pd(from.as_ptr())))
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        assert!(to.len() >= 4);
        op!(_mm256_storeu_pd(to.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn fill(self, mask: Mask4, from: &[f64]) -> Self {
        let next = op!(_mm256_castpd_si256(Self::load(from).0));
        Self::select(mask, Self(op!(_mm256_castsi256_pd(spread(mask, next)))), self)
    }
    #[inline(always)]
    fn fill_words(bits: U64x4, mask: Mask4, from: &[u64]) -> U64x4 {
        Self::choose(mask, U64x4(spread(mask, Self::load_words(from).0)), bits)
    }
    #[inline(always)]
    fn store_words(bits: U64x4, to: &mut [u64]) {
        assert!(to.len() >= 4);
        op!(_mm256_storeu_si256(to.as_mut_ptr().cast(), bits.0));
    }
    #[inline(always)]
    fn load_words(from: &[u64]) -> U64x4 {
        assert!(from.len() >= 4);
        U64x4(op!(_mm256_loadu_si256(from.as_ptr().cast())))
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        let mut all = [0.0; 4];
        op!(_mm256_storeu_pd(all.as_mut_ptr(), self.0));
        all[lane]
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, value: f64) {
        let mut all = [0.0; 4];
        op!(_mm256_storeu_pd(all.as_mut_ptr(), self.0));
        all[lane] = value;
        self.0 = op!(_mm256_loadu_pd(all.as_ptr()));
    }
    #[inline(always)]
    fn word(bits: &U64x4, lane: usize) -> u64 {
        let mut all = [0_u64; 4];
        op!(_mm256_storeu_si256(all.as_mut_ptr().cast(), bits.0));
        all[lane]
    }
    #[inline(always)]
    fn set_word(bits: &mut U64x4, lane: usize, word: u64) {
        let mut all = [0_u64; 4];
        op!(_mm256_storeu_si256(all.as_mut_ptr().cast(), bits.0));
        all[lane] = word;
        bits.0 = op!(_mm256_loadu_si256(all.as_ptr().cast()));
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Mask4 {
        Mask4(op!(_mm256_cmp_pd::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn number(bits: U64x4) -> Self {
        // Halves as the lowest digits of 2^84 and of 2^52; what is then taken away was added by that.
        op!({
            let high = _mm256_or_si256(_mm256_srli_epi64::<32>(bits.0), _mm256_castpd_si256(_mm256_set1_pd(TWO_84)));
            let low = _mm256_blend_epi32::<0b1010_1010>(bits.0, _mm256_castpd_si256(_mm256_set1_pd(TWO_52)));
            let high = _mm256_sub_pd(_mm256_castsi256_pd(high), _mm256_set1_pd(TWO_84 + TWO_52));
            Self(_mm256_add_pd(high, _mm256_castsi256_pd(low)))
        })
    }
    #[inline(always)]
    fn unit(bits: U64x4) -> Self {
        Self::number(bits.down::<11>()) * Self::splat(1.0 / 9_007_199_254_740_992.0)
    }
    #[inline(always)]
    fn choose(mask: Mask4, yes: U64x4, no: U64x4) -> U64x4 {
        U64x4(op!(_mm256_blendv_epi8(no.0, yes.0, _mm256_castpd_si256(mask.0))))
    }
    #[inline(always)]
    fn less(a: U64x4, b: U64x4) -> Mask4 {
        Mask4(op!(_mm256_castsi256_pd(_mm256_cmpgt_epi64(b.0, a.0))))
    }
    #[inline(always)]
    fn same(a: U64x4, b: U64x4) -> Mask4 {
        Mask4(op!(_mm256_castsi256_pd(_mm256_cmpeq_epi64(a.0, b.0))))
    }
    #[inline(always)]
    fn rows(table: &Table, rows: Self) -> [Self; 4] {
        let mut numbers = [0.0; 4];
        op!(_mm256_storeu_pd(numbers.as_mut_ptr(), rows.0));
        op!({
            let a = _mm256_loadu_pd(table.row(numbers[0]).as_ptr());
            let b = _mm256_loadu_pd(table.row(numbers[1]).as_ptr());
            let c = _mm256_loadu_pd(table.row(numbers[2]).as_ptr());
            let d = _mm256_loadu_pd(table.row(numbers[3]).as_ptr());
            // The transpose of four by four.
            let (ab0, ab1) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (cd0, cd1) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            [
                Self(_mm256_permute2f128_pd::<0x20>(ab0, cd0)),
                Self(_mm256_permute2f128_pd::<0x20>(ab1, cd1)),
                Self(_mm256_permute2f128_pd::<0x31>(ab0, cd0)),
                Self(_mm256_permute2f128_pd::<0x31>(ab1, cd1)),
            ]
        })
    }
}

/// For each mask, the halves of words that its lanes take: the first lane that it holds the first word, and so on.
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
fn spread(mask: Mask4, words: __m256i) -> __m256i {
    let order = &SPREAD[mask.bits() as usize & 15];
    op!(_mm256_permutevar8x32_epi32(words, _mm256_loadu_si256(order.as_ptr().cast())))
}

const TWO_52: f64 = 4_503_599_627_370_496.0;
const TWO_84: f64 = 19_342_813_113_834_066_795_298_816.0;
