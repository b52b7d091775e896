//! Sums and a variance in their simplest form, for comparison with the guarded versions in error and time.

pub(crate) fn f32_sum(values: impl Iterator<Item = f64>) -> f64 {
    f64::from(values.fold(0.0_f32, |sum, value| sum + value as f32))
}

pub(crate) fn f64_sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

/// Running sum with a correction for the rounding error of each addition (W. Kahan, "Further remarks on reducing
/// truncation errors", Communications of the ACM 8, 1965). It assumes that the sum is larger than the next value, so a
/// larger value defeats it.
pub(crate) fn kahan_sum(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0, 0.0);
    for value in values {
        let corrected = value - lost;
        let next = sum + corrected;
        lost = (next - sum) - corrected;
        sum = next;
    }
    sum
}

/// The mean of squares minus the square of the mean, over all values.
pub(crate) fn variance_by_squares(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = f64_sum(values.iter().copied()) / n;
    f64_sum(values.iter().map(|value| value * value)) / n - mean * mean
}
