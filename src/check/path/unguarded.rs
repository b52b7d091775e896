//! Sums and a variance as one would write them without further thought: what the guards are compared with, in error and in time.

/// Added one after the other in f32.
pub(in crate::check) fn f32_sum(values: impl Iterator<Item = f64>) -> f64 {
    f64::from(values.fold(0.0_f32, |sum, value| sum + value as f32))
}

/// Added one after the other in f64.
pub(in crate::check) fn f64_sum(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |sum, value| sum + value)
}

/// With a correction for what each addition lost (W. Kahan, "Further remarks on reducing truncation errors", Communications of the ACM 8,
/// 1965). It takes the sum for the larger of both, so that a larger value undoes it.
pub(in crate::check) fn kahan_sum(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0, 0.0);
    for value in values {
        let corrected = value - lost;
        let next = sum + corrected;
        lost = (next - sum) - corrected;
        sum = next;
    }
    sum
}

/// The mean of squares less the square of the mean, over all values.
pub(in crate::check) fn variance_by_squares(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = f64_sum(values.iter().copied()) / n;
    f64_sum(values.iter().map(|value| value * value)) / n - mean * mean
}
