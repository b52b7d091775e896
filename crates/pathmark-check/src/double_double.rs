//! Double-double arithmetic, for oracles: twice the digits of f64 from f64 operations alone.

use std::ops::{Add, Mul, Neg, Sub};

/// A number as an unevaluated sum of two f64: 106 bits (Dekker, 1971; products split after Veltkamp, without fused
/// operations).
#[derive(Clone, Copy)]
pub(super) struct Dd(pub(super) f64, pub(super) f64);

/// The exact sum.
pub(super) fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let t = s - a;
    Dd(s, (a - (s - t)) + (b - t))
}

/// The exact product.
pub(super) fn two_product(a: f64, b: f64) -> Dd {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let (p, (ah, al), (bh, bl)) = (a * b, split(a), split(b));
    Dd(p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Add for Dd {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let (s, t) = (two_sum(self.0, o.0), two_sum(self.1, o.1));
        let s = two_sum(s.0, s.1 + t.0);
        two_sum(s.0, s.1 + t.1)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = two_product(self.0, o.0);
        two_sum(p.0, p.1 + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Dd {
    /// The quotient, rounded once.
    pub(super) fn over(self, o: Self) -> f64 {
        let q = self.0 / o.0;
        q + (self - o * Self(q, 0.0)).0 / o.0
    }
    pub(super) fn sqrt(self) -> Self {
        let root = self.0.sqrt();
        if root == 0.0 { self } else { two_sum(root, (self - two_product(root, root)).0 / (2.0 * root)) }
    }
}
