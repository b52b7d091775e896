//! Tests of random numbers: scores that are standard normal for random numbers, and far from 0 on either side for
//! others.

pub mod battery;
pub mod fourier;

/// Returns √n times the correlation of two sequences of uniform numbers in [-1/2, 1/2), up to the end of the shorter
/// one. It is standard normal if they are independent.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    12.0 * sum / (a.len().min(b.len()) as f64).sqrt()
}

fn repeats<T: Ord>(mut all: Vec<T>) -> u64 {
    all.sort_unstable();
    all.windows(2).filter(|two| two[0] == two[1]).count() as u64
}

/// Counts the keys, of at most 128 bits, that have occurred before.
pub fn repeated(all: Vec<u128>) -> u64 {
    repeats(all)
}

/// Counts the words of 32 bits that have occurred before.
pub fn repeated_words(all: Vec<u32>) -> u64 {
    repeats(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_counts_but_the_first_of_its_kind() {
        assert_eq!(repeated(vec![3, 1 << 100, 3, 3, 0, 1 << 100]), 3);
        assert_eq!(repeated_words(vec![7, 8, 9]), 0);
        assert_eq!(repeated(Vec::new()), 0);
    }

    #[test]
    fn a_sequence_goes_with_itself_and_against_its_opposite() {
        // Uniform numbers have variance 1/12. These n even steps have it up to a relative error of 1/n².
        let n = 1000;
        let even: Vec<f64> = (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n) - 0.5).collect();
        let opposite: Vec<f64> = even.iter().map(|x| -x).collect();
        let all = f64::from(n).sqrt();
        assert!((correlation(&even, &even) - all).abs() < 1e-4 * all);
        assert_eq!(correlation(&even, &opposite), -correlation(&even, &even));
        assert_eq!(correlation(&even[..4], &even), correlation(&even[..4], &even[..4]));
    }
}
