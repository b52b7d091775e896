//! Correlation of two sequences of random numbers.

/// Returns √n times the correlation of two sequences of uniform numbers in [-1/2, 1/2), up to the end of the shorter
/// one. It is standard normal if they are independent.
pub fn of_uniform(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    12.0 * sum / (a.len().min(b.len()) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sequence_goes_with_itself_and_against_its_opposite() {
        // Uniform numbers have variance 1/12. These n even steps have it up to a relative error of 1/n².
        let n = 1000;
        let even: Vec<f64> = (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n) - 0.5).collect();
        let opposite: Vec<f64> = even.iter().map(|x| -x).collect();
        let all = f64::from(n).sqrt();
        assert!((of_uniform(&even, &even) - all).abs() < 1e-4 * all);
        assert_eq!(of_uniform(&even, &opposite), -of_uniform(&even, &even));
        assert_eq!(of_uniform(&even[..4], &even), of_uniform(&even[..4], &even[..4]));
    }
}
