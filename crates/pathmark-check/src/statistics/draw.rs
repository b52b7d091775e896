//! Random numbers of known distributions, and images with known noise.

use crate::image_io::Image;
use rand::Rng;
use rand_pcg::Pcg64Dxsm;
use std::f64::consts::TAU;

/// A random number generator. Each use has a different seed.
pub(super) struct Draw(Pcg64Dxsm);

impl Draw {
    pub(super) fn new(seed: u128) -> Self {
        Self(Pcg64Dxsm::new(seed, 6))
    }

    /// Uniform in (0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    /// Standard normal, by G. E. P. Box and M. E. Muller (1958).
    pub(super) fn normal(&mut self) -> f64 {
        (-2.0 * libm::log(self.uniform())).sqrt() * libm::cos(TAU * self.uniform())
    }

    /// Log-normal with mean 1 and this standard deviation.
    pub(super) fn log_normal(&mut self, deviation: f64) -> f64 {
        let variance = libm::log1p(deviation * deviation);
        libm::exp(variance.sqrt() * self.normal() - 0.5 * variance)
    }

    /// An image of one value in all pixels, with independent normal noise of this standard deviation.
    pub(super) fn picture(&mut self, side: u32, value: f64, deviation: f64) -> Image {
        let mut image = Image::new(side, side);
        for value_of_pixel in image.pixels.as_flattened_mut() {
            *value_of_pixel = value + deviation * self.normal();
        }
        image
    }
}
