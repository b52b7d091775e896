//! Random numbers and directions from fixed seeds.

use crate::math::{Vec3, dot};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use std::f64::consts::TAU;

/// A generator of random values.
pub(super) struct Random(Pcg64Mcg);

impl Random {
    /// The generator with this seed; each case uses a different seed.
    pub(super) fn new(seed: u128) -> Self {
        Self(Pcg64Mcg::new(seed))
    }

    /// A random index below `count`.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }
    /// A number in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// 10^U(low, high).
    pub(super) fn scale(&mut self, low: f64, high: f64) -> f64 {
        libm::exp10(low + (high - low) * self.unit())
    }
    /// A unit vector, uniform over the sphere.
    pub(super) fn direction(&mut self) -> Vec3 {
        loop {
            let v = Vec3::new(2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0);
            if (0.01..1.0).contains(&dot(v, v)) {
                return v.normalized();
            }
        }
    }
    /// Normal with mean 0 and this standard deviation, by G. E. P. Box and M. E. Muller (1958).
    pub(super) fn normal(&mut self, deviation: f64) -> f64 {
        let mut uniform = || ((self.0.next_u64() >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        deviation * (-2.0 * libm::log(uniform())).sqrt() * libm::cos(TAU * uniform())
    }
    pub(super) fn shuffle<T>(&mut self, values: &mut [T]) {
        for last in (1..values.len()).rev() {
            values.swap(last, self.below(last + 1));
        }
    }
}
