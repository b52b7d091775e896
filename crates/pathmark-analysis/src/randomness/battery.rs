//! Tests of random numbers of 53 bits, like those in batteries of tests of generators (Marsaglia, 1985).

use super::repeated_words;
use crate::chi_square::{against, even};

/// Tests whether each of the leading six bytes is evenly distributed.
pub fn bytes(numbers: &[u64]) -> f64 {
    let mut cells = vec![0; 6 * 256];
    for number in numbers {
        (0..6).for_each(|byte| cells[256 * byte + (number >> (45 - 8 * byte) & 0xFF) as usize] += 1);
    }
    let scores: f64 = cells.chunks(256).map(even).sum();
    // Not a number: a constant byte (score infinity) together with one that is far too even (score minus infinity).
    if scores.is_nan() { f64::INFINITY } else { scores / 6.0_f64.sqrt() }
}

/// Tests whether the first bytes of two successive numbers are evenly distributed.
pub fn pairs(numbers: &[u64]) -> f64 {
    let mut cells = vec![0; 1 << 16];
    numbers.chunks_exact(2).for_each(|two| cells[(two[0] >> 45 << 8 | two[1] >> 45) as usize] += 1);
    even(&cells)
}

/// Returns the score farthest from 0 among the 53 leading bits, each of which should be 1 half of the time.
pub fn single_bits(numbers: &[u64]) -> f64 {
    let n = numbers.len() as f64;
    let score = |bit: u32| {
        let ones = numbers.iter().filter(|number| **number >> bit & 1 == 1).count() as f64;
        (2.0 * ones - n) / n.sqrt()
    };
    (0..53).map(score).fold(0.0, |worst: f64, z| if z.abs() > worst.abs() { z } else { worst })
}

/// Marsaglia's birthday spacings: the spacings of 4096 birthdays in a year of 2^32 days have 4096³/2^34 = 4 repetitions
/// on average.
pub fn birthdays(numbers: &[u64]) -> f64 {
    let mut repeated = 0.0;
    let groups = numbers.chunks_exact(4096);
    let expected = 4.0 * groups.len() as f64;
    for group in groups {
        let mut days: Vec<u32> = group.iter().map(|number| (number >> 21) as u32).collect();
        days.sort_unstable();
        repeated += repeated_words(days.windows(2).map(|two| two[1] - two[0]).collect()) as f64;
    }
    (repeated - expected) / expected.sqrt()
}

/// Returns the number of linearly independent rows among 32 rows of bits.
fn rank(mut rows: [u32; 32]) -> usize {
    let mut rank = 0;
    for column in 0..32 {
        let Some(pivot) = (rank..32).find(|row| rows[*row] >> column & 1 == 1) else { continue };
        rows.swap(rank, pivot);
        let own = rows[rank];
        rows[rank + 1..].iter_mut().filter(|row| **row >> column & 1 == 1).for_each(|row| *row ^= own);
        rank += 1;
    }
    rank
}

/// Tests the ranks of matrices of 32 by 32 bits: 28.88 % of random ones have full rank and 57.76 % one less.
pub fn ranks(numbers: &[u64]) -> f64 {
    let mut cells = [0.0; 3];
    for group in numbers.chunks_exact(32) {
        let rows = std::array::from_fn(|row| (group[row] >> 21) as u32);
        cells[(32 - rank(rows)).min(2)] += 1.0;
    }
    let n: f64 = cells.iter().sum();
    against(&cells, &[0.288_788_095_2 * n, 0.577_576_190_2 * n, 0.133_635_714_6 * n])
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    type Test = fn(&[u64]) -> f64;

    /// A sound generator passes each test. A counter fails each, on one side or the other.
    #[test]
    fn each_test_tells_random_numbers_from_others() {
        let tests: [(&str, Test); 5] =
            [("bytes", bytes), ("pairs", pairs), ("bits", single_bits), ("birthdays", birthdays), ("ranks", ranks)];
        let mut generator = Pcg64::seed_from_u64(7);
        let random: Vec<u64> = (0..1 << 18).map(|_| generator.next_u64() >> 11).collect();
        let counted: Vec<u64> = (0..1 << 18).map(|k| k << 30).collect();
        for (name, test) in tests {
            // The score of the bits is the largest of 53; 5 standard deviations occur once in a million.
            assert!(test(&random).abs() < 5.0, "{name}: {}", test(&random));
            assert!(test(&counted).abs() > 50.0, "{name}: {}", test(&counted));
        }
    }

    #[test]
    fn ranks_of_known_matrices() {
        assert_eq!(rank(std::array::from_fn(|row| 1 << row)), 32);
        assert_eq!(rank([5; 32]), 1);
        assert_eq!(rank([0; 32]), 0);
    }
}
