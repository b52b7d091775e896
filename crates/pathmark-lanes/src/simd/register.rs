//! Registers of numbers for any instruction set: a type lists the intrinsics that are its operations.

/// An intrinsic of an instruction set that not every processor has. Values of such a set's types are made only within
/// its `enter`, which runs only on processors with these instructions.
macro_rules! op {
    ($call:expr) => {
        // SAFETY: reached through `enter` alone, as above; loads and stores go to arrays of the register's size.
        unsafe { $call }
    };
}

/// The entry into code for an instruction set: its registers in both formats, and the features of processors that it
/// needs. These include the instructions that count bits, which all processors with AVX2 have: the compiler does not infer
/// them from AVX2, and lanes of a mask are counted often.
macro_rules! instruction_set {
    ($Double:ident, $Single:ident; $($feature:tt)*) => {
        /// Whether this processor has the instructions used here.
        pub(super) fn is_available() -> bool {
            $(is_x86_feature_detected!($feature))&&*
        }

        /// Runs `work` with this instruction set.
        pub(super) fn run<W: Work>(precision: Precision, work: W) -> W::Output {
            // SAFETY: `on_level` alone comes here, with a level that has been found on this processor.
            unsafe {
                match precision {
                    Precision::F64 => enter::<Pair<$Double>, W>(work),
                    Precision::F32 => enter::<Pair<$Single>, W>(work),
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
    };
}

/// Operators of a register that are one intrinsic each.
macro_rules! operator {
    ($Type:ident: $($Trait:ident $method:ident $intrinsic:ident),*) => {$(
        impl std::ops::$Trait for $Type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(op!(x86::$intrinsic(self.0, other.0)))
            }
        }
    )*};
}

/// A register of numbers by its intrinsics. `own` holds its own implementations of the other methods of
/// [`Float`](super::Float).
macro_rules! register {
    (
        $(#[$about:meta])*
        $Type:ident($Raw:ident) = $lanes:literal $One:ident, $Mask:ident, $Bits:ty, $Digits:ty, $Single:ty;
        splat $splat:ident, load $load:ident, store $store:ident, compare $compare:ident, fused $fused:ident,
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, xor $xor:ident,
        sqrt $sqrt:ident, min $min:ident, max $max:ident;
        abs($abs_of:ident) = $abs:expr;
        copysign($magnitude:ident, $sign:ident) = $copysign:expr;
        select($mask:ident, $yes:ident, $no:ident) = $select:expr;
        own { $(fn $own:ident($($argument:tt)*) $(-> $Result:ty)? $body:block)* }
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy)]
        pub(in crate::simd) struct $Type(pub(super) x86::$Raw);

        operator!($Type: Add add $add, Sub sub $sub, Mul mul $mul, Div div $div);

        impl std::ops::Neg for $Type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(op!(x86::$xor(self.0, x86::$splat(-0.0))))
            }
        }

        impl pathmark_tracer::math::Real for $Type {
            type Mask = $Mask;
            const SIGNIFICAND: u32 = $One::MANTISSA_DIGITS;
            const SMALLEST: f64 = $One::SMALLEST;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self(op!(x86::$splat(value as $One)))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(op!(x86::$sqrt(self.0)))
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
                $Mask(op!(x86::$compare::<{ x86::_CMP_LT_OQ }>(self.0, other.0)))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $Mask {
                $Mask(op!(x86::$compare::<{ x86::_CMP_LE_OQ }>(self.0, other.0)))
            }
            #[inline(always)]
            fn select(mask: $Mask, yes: Self, no: Self) -> Self {
                let ($mask, $yes, $no) = (mask.0, yes.0, no.0);
                Self(op!($select))
            }
        }

        impl super::Float for $Type {
            type Bits = $Bits;
            type Digits = $Digits;
            type One = $One;
            type Single = $Single;
            type Register = Self;
            const LANES: usize = $lanes;

            #[inline(always)]
            fn load(from: &[$One]) -> Self {
                assert!(from.len() >= $lanes);
                Self(op!(x86::$load(from.as_ptr())))
            }
            #[inline(always)]
            fn store(self, to: &mut [$One]) {
                assert!(to.len() >= $lanes);
                op!(x86::$store(to.as_mut_ptr(), self.0));
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
                $Mask(op!(x86::$compare::<{ x86::_CMP_EQ_OQ }>(self.0, other.0)))
            }
            // Like the processor: if either is NaN, the second.
            #[inline(always)]
            fn larger(self, other: Self) -> Self {
                Self(op!(x86::$max(self.0, other.0)))
            }
            #[inline(always)]
            fn smaller(self, other: Self) -> Self {
                Self(op!(x86::$min(self.0, other.0)))
            }
            #[inline(always)]
            fn about_times_plus(self, factor: Self, addend: Self) -> Self {
                Self(op!(x86::$fused(self.0, factor.0, addend.0)))
            }
            #[inline(always)]
            fn ask_for(address: *const i8) {
                op!(x86::_mm_prefetch::<{ x86::_MM_HINT_T0 }>(address));
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
