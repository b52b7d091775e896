//! Exact arithmetic on f64, to confirm the oracles: every finite f64 is an integer multiple of 2^-1074. A product of n
//! factors has the unit 2^(-1074 n). Quotients are compared by cross-multiplication.

use crate::math::Vec3;
use num_bigint::BigInt;

/// The unit's exponent: the smallest subnormal number is 2^-1074.
pub(super) const UNIT: u32 = 1074;

/// The number in units.
pub(super) fn fixed(x: f64) -> BigInt {
    assert!(x.is_finite());
    let exponent = (x.to_bits() >> 52 & 0x7FF) as u32;
    let fraction = x.to_bits() & ((1 << 52) - 1);
    let (mantissa, shift) = if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 52, exponent - 1) };
    let magnitude = BigInt::from(mantissa) << shift;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// The three components in units.
pub(super) fn fixed_vector(v: Vec3) -> [BigInt; 3] {
    [fixed(v.x), fixed(v.y), fixed(v.z)]
}

/// The scalar product.
pub(super) fn dot([a, b, c]: &[BigInt; 3], [d, e, f]: &[BigInt; 3]) -> BigInt {
    a * d + b * e + c * f
}

/// The vector product.
pub(super) fn cross([a, b, c]: &[BigInt; 3], [d, e, f]: &[BigInt; 3]) -> [BigInt; 3] {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

pub(super) fn minus([a, b, c]: &[BigInt; 3], [d, e, f]: &[BigInt; 3]) -> [BigInt; 3] {
    [a - d, b - e, c - f]
}

#[test]
fn units_are_exact() {
    let one = BigInt::from(1) << UNIT;
    assert_eq!(fixed(1.0), one);
    assert_eq!(fixed(-0.75) * 4, -one.clone() * 3);
    assert_eq!(fixed(5e-324), BigInt::from(1));
    assert_eq!(fixed(f64::MIN_POSITIVE), BigInt::from(1_u64 << 52));
    assert_eq!(fixed(0.0), BigInt::from(0));
    assert_eq!(fixed(0.1) * 10 - &one, fixed(libm::exp2(-54.0)));
}
