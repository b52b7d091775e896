//! Noise: a film's error, estimated from its own samples.
//!
//! A pixel's estimate from n samples has the variance s²/n, so the mean of s²/n over pixels and channels is its
//! expected squared error. The squared error of one image scatters around that. For normal errors with v a pixel's
//! variance, its squared error has the variance 2v² and its s²/n the variance 2v²/(n - 1). Heavy tails add the same to
//! both variances and to the covariance (with fourth cumulant k: k/n³ each), so they cancel in the difference. If the
//! channels of a pixel are treated as one number, which is the worst case, the difference of an image's squared error
//! and its estimate has the variance 2/P² · n/(n - 1) · sum of v² over the P pixels.
//!
//! For stratified or low-discrepancy samples s²/n is too large: the true error is smaller.

use super::{Film, PixelSum};

/// Fewest pixels whose errors average out enough for a normal bound.
pub const FEWEST_PIXELS: usize = 64;

/// A film's error as estimated from its samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// The expected squared error: mean over pixels and channels.
    pub mse: f64,
    /// Standard deviation of the difference between the image's own squared error and `mse`.
    pub scatter: f64,
}

impl Noise {
    /// The upper bound of the image's squared error, with the probability of the standard normal quantile `z`.
    pub fn bound(&self, z: f64) -> f64 {
        self.mse + z * self.scatter
    }
}

impl PixelSum {
    /// Variance of the pixel's estimate, averaged over channels; 0 below two samples, which have no variance.
    pub fn variance(&self) -> f64 {
        let n = f64::from(self.count);
        if self.count < 2 {
            return 0.0;
        }
        let spread = |channel: usize| (self.square[channel] - self.sum[channel] * self.sum[channel] / n).max(0.0);
        (spread(0) + spread(1) + spread(2)) / (3.0 * n * (n - 1.0))
    }
}

impl Film {
    /// The mean over pixels of the variance of a pixel's estimate, averaged over channels: the square of the expected
    /// RMSE.
    pub fn mean_variance(&self) -> f64 {
        self.pixels().iter().map(PixelSum::variance).sum::<f64>() / self.pixels().len() as f64
    }

    /// The film's noise; `None` if a pixel has fewer than two samples.
    pub fn noise(&self) -> Option<Noise> {
        let (mut sum, mut squares) = (0.0, 0.0);
        for pixel in self.pixels() {
            if pixel.count < 2 {
                return None;
            }
            let (variance, n) = (pixel.variance(), f64::from(pixel.count));
            sum += variance;
            squares += variance * variance * n / (n - 1.0);
        }
        let pixels = self.pixels().len() as f64;
        Some(Noise { mse: sum / pixels, scatter: (2.0 * squares).sqrt() / pixels })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples 3, 5, 7 and 9: variance 20/3 of a sample, 5/3 of the mean. The other pixel's samples are equal.
    #[test]
    fn known_numbers() {
        let pixel = PixelSum { sum: [24.0; 3], square: [164.0; 3], count: 4 };
        let still = PixelSum { sum: [8.0; 3], square: [16.0; 3], count: 4 };
        let noise = Film::from_pixels(2, 1, vec![pixel, still]).noise().unwrap();
        assert!((noise.mse - 5.0 / 6.0).abs() < 1e-14);
        let scatter = (2.0_f64 * 25.0 / 9.0 * 4.0 / 3.0).sqrt() / 2.0;
        assert!((noise.scatter - scatter).abs() < 1e-14);
        assert!((noise.bound(2.0) - noise.mse - 2.0 * scatter).abs() < 1e-14);
    }

    #[test]
    fn one_sample_does_not_tell() {
        let pixel = PixelSum { sum: [1.0; 3], square: [1.0; 3], count: 1 };
        assert_eq!(Film::from_pixels(1, 1, vec![pixel]).noise(), None);
    }
}
