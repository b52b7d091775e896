//! Random numbers and directions for tests, from fixed seeds.

use pathmark::math::{Vec3, dot};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;

/// A generator with what tests of geometry draw.
pub(crate) struct Random(pub(crate) Pcg64Mcg);

impl Random {
    /// One of so many.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }
    /// From 0 to below 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// 10^U(low, high).
    pub(crate) fn scale(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(low + (high - low) * self.unit())
    }
    /// Of length 1, evenly over the sphere.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0);
            if (0.01..1.0).contains(&dot(v, v)) {
                return v.normalized();
            }
        }
    }
}
