//! Heavy tails: how far a few samples decide a mean. With a heavy tail, a variance estimate is unreliable until there
//! are many samples.
//!
//! A path that finds a small light by chance, or through glass, gives a sample thousands of times the mean. Its square
//! decides the variance.

use serde::Serialize;

use super::interval::all_finite;

#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Tail {
    /// Fourth moment about the mean over the square of the second: 3 for a normal distribution, 1.8 for a uniform one.
    pub kurtosis: f64,
    /// Share of the largest sample in the sum of squared deviations, in (0, 1].
    pub largest_share: f64,
}

/// Measures the tail of groups of samples, such as the samples of each pixel. Deviations are from the group's own mean,
/// moments over all groups.
///
/// A group of m samples has m - 1 free deviations, which reduces its squared deviations by a factor (m - 1)/m. Kurtosis
/// and share stay comparable if all groups have the same size. `None` for a value that is not finite, or without any
/// deviation.
pub fn tail<'a>(groups: impl IntoIterator<Item = &'a [f64]>) -> Option<Tail> {
    let (mut count, mut squares, mut fourths, mut largest) = (0_u64, 0.0, 0.0, 0.0_f64);
    for group in groups {
        if !all_finite(group) {
            return None;
        }
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        for value in group {
            let square = (value - mean) * (value - mean);
            count += 1;
            squares += square;
            fourths += square * square;
            largest = largest.max(square);
        }
    }
    let kurtosis = count as f64 * fourths / (squares * squares);
    (squares > 0.0 && kurtosis.is_finite()).then(|| Tail { kurtosis, largest_share: largest / squares })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_of_different_brightness_are_no_tail() {
        let pixels: Vec<Vec<f64>> = (0..50).map(|k| vec![f64::from(k), f64::from(k) + 1.0]).collect();
        let found = tail(pixels.iter().map(Vec::as_slice)).unwrap();
        assert!((found.kurtosis - 1.0).abs() < 1e-12 && (found.largest_share - 0.01).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        let none: [&[f64]; 0] = [];
        assert_eq!(tail(none), None);
        assert_eq!(tail([[1.0, 1.0].as_slice()]), None);
        assert_eq!(tail([[1.0, f64::NAN].as_slice()]), None);
    }
}
