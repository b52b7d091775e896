//! Small arrays, from which compilers make instructions that every processor of its kind has: SSE2 or NEON.

use super::{Apart, Float, Mask, Precision, Table, Words, Work};
use pathmark_tracer::math::{Bits, Real, single_unit, unit};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// Two numbers in double precision fill a register of SSE2 or NEON. More take longer to compile and are no faster.
const LANES: usize = 2;

/// Available on every processor.
pub(super) fn is_available() -> bool {
    true
}

/// x86 processors without a better instruction set are older than 2013, and every ARM processor has NEON.
pub(super) const IS_FALLBACK: bool = cfg!(any(target_arch = "x86_64", target_arch = "aarch64"));

/// Runs `work` with this instruction set.
pub(super) fn run<W: Work>(precision: Precision, work: W) -> W::Output {
    assert!(!(IS_FALLBACK && W::IS_SHORTCUT), "a fallback is not compiled for shortcuts");
    match precision {
        Precision::F64 => work.run::<Plain<f64>>(),
        Precision::F32 => work.run::<Plain<f32>>(),
    }
}

/// One value per lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain<T>([T; LANES]);

/// Computes a value for each lane. Written out, because a closure in a loop may stay a call.
macro_rules! each {
    ($k:ident => $value:expr) => {
        Plain([
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
        ])
    };
}

macro_rules! operators {
    ($($Trait:ident $method:ident),*) => {$(
        impl<T: Copy + $Trait<Output = T>> $Trait for Plain<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                each!(k => self.0[k].$method(other.0[k]))
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor, BitXor bitxor);

impl<T: Copy + Neg<Output = T>> Neg for Plain<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        each!(k => -self.0[k])
    }
}

impl<T: Copy + Not<Output = T>> Not for Plain<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        each!(k => !self.0[k])
    }
}

impl Bits for Plain<u64> {
    #[inline(always)]
    fn splat(word: u64) -> Self {
        Self([word; LANES])
    }
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        each!(k => self.0[k].wrapping_add(other.0[k]))
    }
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        each!(k => self.0[k].wrapping_mul(other.0[k]))
    }
    #[inline(always)]
    fn times_low(self, other: Self) -> Self {
        each!(k => self.0[k].times_low(other.0[k]))
    }
    #[inline(always)]
    fn up<const N: u32>(self) -> Self {
        each!(k => self.0[k] << N)
    }
    #[inline(always)]
    fn down<const N: u32>(self) -> Self {
        each!(k => self.0[k] >> N)
    }
    #[inline(always)]
    fn down_by(self, count: Self) -> Self {
        each!(k => self.0[k] >> count.0[k])
    }
    #[inline(always)]
    fn reversed(self) -> Self {
        each!(k => self.0[k].reverse_bits())
    }
}

impl Mask for Plain<bool> {
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        each!(k => bits >> k & 1 == 1)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        let [a, b] = self.0.map(u32::from);
        a | b << 1
    }
}

impl<T: Copy> Plain<T> {
    /// `self`, but lanes in the mask get the next of the values, in order.
    #[inline(always)]
    fn filled(mut self, mask: Plain<bool>, from: &[T]) -> Self {
        let mut next = 0;
        for (lane, wanted) in self.0.iter_mut().zip(mask.0) {
            if wanted {
                *lane = from[next];
                next += 1;
            }
        }
        self
    }
}

impl Words<Plain<bool>> for Plain<u64> {
    #[inline(always)]
    fn load(from: &[u64]) -> Self {
        each!(k => from[k])
    }
    #[inline(always)]
    fn store(self, to: &mut [u64]) {
        to[..LANES].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn fill(self, mask: Plain<bool>, from: &[u64]) -> Self {
        self.filled(mask, from)
    }
    #[inline(always)]
    fn word(&self, lane: usize) -> u64 {
        self.0[lane]
    }
    #[inline(always)]
    fn set_word(&mut self, lane: usize, word: u64) {
        self.0[lane] = word;
    }
    #[inline(always)]
    fn choose(mask: Plain<bool>, yes: Self, no: Self) -> Self {
        each!(k => if mask.0[k] { yes.0[k] } else { no.0[k] })
    }
    #[inline(always)]
    fn less(self, other: Self) -> Plain<bool> {
        each!(k => self.0[k] < other.0[k])
    }
    #[inline(always)]
    fn equal(self, other: Self) -> Plain<bool> {
        each!(k => self.0[k] == other.0[k])
    }
}

macro_rules! float {
    ($Float:ident, $row:ident, $unit:expr, $times_plus:expr) => {
        impl Real for Plain<$Float> {
            type Mask = Plain<bool>;
            const SIGNIFICAND: u32 = $Float::SIGNIFICAND;
            const SMALLEST: f64 = $Float::SMALLEST;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([value as $Float; LANES])
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                each!(k => self.0[k].sqrt())
            }
            #[inline(always)]
            fn abs(self) -> Self {
                each!(k => self.0[k].abs())
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                each!(k => $times_plus(self.0[k], factor.0[k], addend.0[k]))
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                each!(k => self.0[k].copysign(sign.0[k]))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Plain<bool> {
                each!(k => self.0[k] < other.0[k])
            }
            #[inline(always)]
            fn le(self, other: Self) -> Plain<bool> {
                each!(k => self.0[k] <= other.0[k])
            }
            #[inline(always)]
            fn select(mask: Plain<bool>, yes: Self, no: Self) -> Self {
                each!(k => if mask.0[k] { yes.0[k] } else { no.0[k] })
            }
        }

        impl Float for Plain<$Float> {
            type Bits = Plain<u64>;
            type Digits = Plain<u64>;
            type One = $Float;
            type Single = Plain<f32>;
            type Register = Self;
            const LANES: usize = LANES;

            #[inline(always)]
            fn load(from: &[$Float]) -> Self {
                each!(k => from[k])
            }
            #[inline(always)]
            fn store(self, to: &mut [$Float]) {
                to[..LANES].copy_from_slice(&self.0);
            }
            #[inline(always)]
            fn fill(self, mask: Plain<bool>, from: &[$Float]) -> Self {
                self.filled(mask, from)
            }
            #[inline(always)]
            fn one(value: f64) -> $Float {
                value as $Float
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> f64 {
                self.0[lane].into()
            }
            #[inline(always)]
            fn set_lane(&mut self, lane: usize, value: f64) {
                self.0[lane] = value as $Float;
            }
            #[inline(always)]
            fn equal(self, other: Self) -> Plain<bool> {
                each!(k => self.0[k] == other.0[k])
            }
            #[inline(always)]
            fn about_times_plus(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }
            #[inline(always)]
            fn number(bits: Plain<u64>) -> Self {
                each!(k => bits.0[k] as $Float)
            }
            #[inline(always)]
            fn unit(bits: Plain<u64>) -> Self {
                each!(k => $unit(bits.0[k]))
            }
            #[inline(always)]
            fn halves(bits: Plain<u64>) -> [Plain<u64>; 2] {
                [bits, bits.down::<32>()]
            }
            #[inline(always)]
            fn choose_digits(mask: Plain<bool>, yes: Plain<u64>, no: Plain<u64>) -> Plain<u64> {
                Plain::<u64>::choose(mask, yes, no)
            }
            #[inline(always)]
            fn fraction(digits: Plain<u64>) -> Self {
                Self::unit(digits.reversed())
            }
            #[inline(never)]
            fn apart<W: Apart>(work: W) -> W::Output {
                work.run()
            }
            #[inline(always)]
            fn rows(table: &Table, rows: Self) -> [Self; 4] {
                let [a, b] = [table.$row(rows.0[0] as i32), table.$row(rows.0[1] as i32)];
                [0, 1, 2, 3].map(|column| Self([a[column], b[column]]))
            }
        }
    };
}

#[inline(always)]
fn in_two_steps(a: f64, b: f64, c: f64) -> f64 {
    a * b + c
}

float!(f64, row, unit, in_two_steps);
float!(f32, single_row, single_unit, libm::fmaf);
