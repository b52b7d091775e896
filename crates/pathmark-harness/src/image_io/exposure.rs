//! Automatic exposure, as in report C: the brightest channel of the whole picture becomes 1. It is for viewing only,
//! not for measuring: one bright pixel darkens all others, so the values of two exposed pictures are not comparable.

use super::Image;

/// Returns the picture divided by its largest finite channel; unchanged if that is not above zero.
#[must_use]
pub fn auto_exposed(image: &Image) -> Image {
    let finite = image.pixels.iter().flatten().copied().filter(|value| value.is_finite());
    let largest = finite.fold(0.0, f64::max);
    if largest <= 0.0 {
        return image.clone();
    }
    // Divided, not multiplied by the inverse: the largest value must become exactly 1, even if its inverse is infinite.
    Image { pixels: image.pixels.iter().map(|pixel| pixel.map(|value| value / largest)).collect(), ..*image }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(values: &[f64]) -> Image {
        let pixels: Vec<_> = values.iter().map(|value| [*value, 0.0, 0.25]).collect();
        Image { width: values.len() as u32, height: 1, pixels }
    }

    #[test]
    fn the_largest_channel_becomes_one() {
        assert_eq!(auto_exposed(&row(&[4.0, 1.0])).pixels, [[1.0, 0.0, 0.0625], [0.25, 0.0, 0.0625]]);
        // Dark pictures are brightened.
        assert_eq!(auto_exposed(&row(&[0.125])).pixels, [[0.5, 0.0, 1.0]]);
        for value in [0.1, 0.3, 7.0, 1e300] {
            assert_eq!(auto_exposed(&row(&[value, 0.01])).pixels.iter().flatten().copied().fold(0.0, f64::max), 1.0);
        }
    }

    #[test]
    fn images_without_a_largest_value_stay() {
        assert_eq!(auto_exposed(&Image::new(3, 2)), Image::new(3, 2));
        let tiny = Image { width: 1, height: 1, pixels: vec![[5e-324, 0.0, 0.0]] };
        assert_eq!(auto_exposed(&tiny).pixels, [[1.0, 0.0, 0.0]]);
        let odd = Image { width: 1, height: 1, pixels: vec![[f64::INFINITY, 2.0, f64::NAN]] };
        let [infinite, largest, nan] = auto_exposed(&odd).pixels[0];
        assert!(infinite == f64::INFINITY && largest == 1.0 && nan.is_nan());
    }
}
