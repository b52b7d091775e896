//! The numbers that a record tells of a film, by one pass over the pixels, which are more than the caches hold.

use super::{Film, Noise};

/// The error of a film, as estimated from its samples, and the light of its image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summary {
    /// [`Film::noise`].
    pub noise: Option<Noise>,
    /// [`Film::mean_variance`].
    pub mean_variance: f64,
    /// The mean of each channel, as [`super::Image::mean`].
    pub mean: [f64; 3],
    /// Number of pixels without any light.
    pub black_pixels: u64,
}

impl Film {
    /// Adds in the order of the pixels, so each number has the bits of a pass of its own.
    pub fn summary(&self) -> Summary {
        let (mut variances, mut squares, mut sum, mut black_pixels) = (0.0, 0.0, [0.0; 3], 0);
        let mut have_variance = true;
        for pixel in self.pixels() {
            let (variance, n) = (pixel.variance(), f64::from(pixel.count));
            have_variance &= pixel.count > 1;
            variances += variance;
            squares += variance * variance * n / (n - 1.0);
            let mean = pixel.mean();
            for (sum, value) in sum.iter_mut().zip(mean) {
                *sum += value;
            }
            black_pixels += u64::from(mean == [0.0; 3]);
        }
        let pixels = self.pixels().len() as f64;
        let noise = Noise { mse: variances / pixels, scatter: (2.0_f64 * squares).sqrt() / pixels };
        Summary {
            noise: have_variance.then_some(noise),
            mean_variance: variances / pixels,
            mean: sum.map(|sum| sum / pixels),
            black_pixels,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::PixelSum;

    /// Counts of 0, 1 and more samples, some of them dark.
    fn film(counts: &[u32]) -> Film {
        let pixel = |(k, count): (u32, &u32)| {
            let light = if k % 3 == 0 { 0.0 } else { f64::from(k) / 7.0 };
            let sum = [light, 0.3 * light, light * light].map(|value| value * f64::from(*count));
            PixelSum { sum, square: sum.map(|sum| sum * sum / f64::from((*count).max(1)) * 1.1), count: *count }
        };
        let pixels: Vec<PixelSum> = (0..).zip(counts).map(pixel).collect();
        Film::from_pixels(counts.len() as u32, 1, pixels)
    }

    #[test]
    fn it_is_what_single_passes_find() {
        for counts in [&[4, 9, 2, 5, 7, 3, 2][..], &[4, 1, 2, 5, 7], &[0, 0, 3], &[]] {
            let film = film(counts);
            let (summary, image) = (film.summary(), film.image());
            assert_eq!(summary.noise.is_some(), film.noise().is_some());
            if !counts.is_empty() {
                assert_eq!(summary.noise, film.noise());
                assert_eq!(summary.mean_variance.to_bits(), film.mean_variance().to_bits());
                assert_eq!(summary.mean, image.mean());
            }
            let black = image.pixels.iter().filter(|pixel| **pixel == [0.0; 3]).count();
            assert_eq!(summary.black_pixels, black as u64);
        }
    }
}
