//! Registers of numbers for any instruction set: a type lists the intrinsics that are its operations.

use super::Float;

/// An intrinsic of an instruction set. Values of the types of a set that not every processor has are made only within
/// its `enter`, which runs only on processors with these instructions.
macro_rules! op {
    ($call:expr) => {
        // SAFETY: reached through `enter` alone, as above; loads and stores go to arrays of the register's size.
        unsafe { $call }
    };
}

/// The entry into code for an instruction set: the numbers in lanes of both formats, the features of processors that it
/// needs, and a prefetch. The features of AVX2 include the instructions that count bits, which all processors with AVX2
/// have: the compiler does not infer them from AVX2, and lanes of a mask are counted often.
macro_rules! instruction_set {
    ($is_detected:ident[$($feature:tt)*]: $Double:ty, $Single:ty; ask_for($address:ident) = $ask:expr;) => {
        /// Whether this processor has the instructions used here.
        pub(super) fn is_available() -> bool {
            $($is_detected!($feature))&&*
        }

        /// Runs `work` with this instruction set.
        pub(super) fn run<W: Work>(precision: Precision, work: W) -> W::Output {
            // SAFETY: `on_level` alone comes here, with a level that has been found on this processor.
            unsafe {
                match precision {
                    Precision::F64 => enter::<$Double, W>(work),
                    Precision::F32 => enter::<$Single, W>(work),
                }
            }
        }

        #[target_feature($(enable = $feature),*)]
        fn enter<V: Float, W: Work>(work: W) -> W::Output {
            work.run::<V>()
        }

        #[target_feature($(enable = $feature),*)]
        #[inline(never)]
        fn apart<W: Apart>(work: W) -> W::Output {
            work.run()
        }

        #[inline(always)]
        fn ask_for($address: *const i8) {
            $ask
        }
    };
}

/// Operators of a register that are one intrinsic each.
macro_rules! operator {
    ($Type:ident($isa:ident): $($Trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl std::ops::$Trait for $Type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(op!($isa::$intrinsic(self.0, other.0)))
            }
        }
    )*};
}

/// A register of numbers by its intrinsics, which are in the module `$isa`. Operations that are not a single intrinsic
/// in every instruction set are formulas. `own` holds its own implementations of the other methods of [`Float`].
macro_rules! register {
    (
        $(#[$about:meta])*
        $Type:ident($isa:ident::$Raw:ident) = $lanes:literal $One:ident, $Mask:ident, $Bits:ty, $Digits:ty, $Single:ty;
        splat $splat:ident, load $load:ident, store $store:ident,
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, sqrt $sqrt:ident;
        neg($opposite:ident) = $neg:expr;
        abs($abs_of:ident) = $abs:expr;
        copysign($magnitude:ident, $sign:ident) = $copysign:expr;
        fused($fused_of:ident, $factor:ident, $addend:ident) = $fused:expr;
        lt($lt_of:ident, $lt_than:ident) = $lt:expr;
        le($le_of:ident, $le_than:ident) = $le:expr;
        equal($equal_of:ident, $equal_to:ident) = $equal:expr;
        larger($larger_of:ident, $larger_or:ident) = $larger:expr;
        smaller($smaller_of:ident, $smaller_or:ident) = $smaller:expr;
        select($mask:ident, $yes:ident, $no:ident) = $select:expr;
        own { $(fn $own:ident($($argument:tt)*) $(-> $Result:ty)? $body:block)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy)]
        pub(in crate::simd) struct $Type(pub(super) $isa::$Raw);

        operator!($Type($isa): Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl std::ops::Neg for $Type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $opposite = self.0;
                Self(op!($neg))
            }
        }

        impl pathmark_tracer::math::Real for $Type {
            type Mask = $Mask;
            const SIGNIFICAND: u32 = $One::MANTISSA_DIGITS;
            const SMALLEST: f64 = $One::SMALLEST;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self(op!($isa::$splat(value as $One)))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(op!($isa::$sqrt(self.0)))
            }
            #[inline(always)]
            fn abs(self) -> Self {
                let $abs_of = self.0;
                Self(op!($abs))
            }
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                if Self::IS_DOUBLE { self * factor + addend } else { self.about_times_plus(factor, addend) }
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                let ($magnitude, $sign) = (self.0, sign.0);
                Self(op!($copysign))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $Mask {
                let ($lt_of, $lt_than) = (self.0, other.0);
                $Mask(op!($lt))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $Mask {
                let ($le_of, $le_than) = (self.0, other.0);
                $Mask(op!($le))
            }
            #[inline(always)]
            fn select(mask: $Mask, yes: Self, no: Self) -> Self {
                let ($mask, $yes, $no) = (mask.0, yes.0, no.0);
                Self(op!($select))
            }
        }

        impl crate::simd::Float for $Type {
            type Bits = $Bits;
            type Digits = $Digits;
            type One = $One;
            type Single = $Single;
            type Register = Self;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn load(from: &[$One]) -> Self {
                assert!(from.len() >= $lanes);
                Self(op!($isa::$load(from.as_ptr())))
            }
            #[inline(always)]
            fn store(self, to: &mut [$One]) {
                assert!(to.len() >= $lanes);
                op!($isa::$store(to.as_mut_ptr(), self.0));
            }
            #[inline(always)]
            fn one(value: f64) -> $One {
                value as $One
            }
            #[inline(always)]
            fn lane(&self, lane: usize) -> f64 {
                let mut all = [0.0; $lanes];
                self.store(&mut all);
                all[lane].into()
            }
            #[inline(always)]
            fn equal(self, other: Self) -> $Mask {
                let ($equal_of, $equal_to) = (self.0, other.0);
                $Mask(op!($equal))
            }
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                let ($larger_of, $larger_or) = (self.0, other.0);
                Self(op!($larger))
            }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                let ($smaller_of, $smaller_or) = (self.0, other.0);
                Self(op!($smaller))
            }
            #[inline(always)]
            fn about_times_plus(self, factor: Self, addend: Self) -> Self {
                let ($fused_of, $factor, $addend) = (self.0, factor.0, addend.0);
                Self(op!($fused))
            }
            #[inline(always)]
            fn ask_for(address: *const i8) {
                super::ask_for(address);
            }
            #[inline(always)]
            fn apart<W: crate::simd::Apart>(work: W) -> W::Output {
                op!(super::apart(work))
            }
            $(
                #[inline(always)]
                fn $own($($argument)*) $(-> $Result)? $body
            )*
        }
    };
}

/// Lanes with another number in one of them, by way of an array with a number for each of the `N` lanes.
#[inline(always)]
pub(super) fn with_lane<V: Float, const N: usize>(lanes: V, lane: usize, value: f64) -> V {
    let mut all = [V::One::default(); N];
    lanes.store(&mut all);
    all[lane] = V::one(value);
    V::load(&all)
}
