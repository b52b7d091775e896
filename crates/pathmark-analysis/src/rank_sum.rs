//! The ratio of two samples of times that were not measured in pairs.
//!
//! The estimate is the median of all ratios of a value of one sample to a value of the other. The ends of the interval
//! are two of these ratios (J. L. Hodges and E. L. Lehmann, "Estimates of location based on rank tests", 1963; L. E.
//! Moses, 1953). Both samples are assumed to follow the same distribution up to a factor; nothing else is assumed about
//! it. The confidence comes from the exact distribution of Mann and Whitney's U (1947).

use super::autocorrelation::widening;
use super::interval::{Estimate, Interval, all_finite, is_level};
use super::quantile::{quantile_of_sorted, sorted};
use std::cell::RefCell;
use std::collections::HashMap;

/// Largest sample for which the distribution of U is computed; runs are never repeated more often.
const MOST: usize = 200;

/// The intervals of one level. The ranks of their ends are computed once for each pair of sample sizes.
pub struct RankSum {
    level: f64,
    ranks: RefCell<HashMap<(usize, usize), (usize, f64)>>,
}

impl RankSum {
    /// Intervals of at least this confidence.
    pub fn new(level: f64) -> Self {
        Self { level, ranks: RefCell::default() }
    }

    /// Returns the ratio of the values of `new` to the values of `old`, with the narrowest interval of at least the
    /// requested confidence. If there are too few values for it, the interval spans all ratios, with a level below the
    /// requested one. `None` for fewer than two or more than 200 values in a sample, and for values that are not
    /// positive and finite.
    ///
    /// ```
    /// use pathmark_analysis::rank_sum::RankSum;
    /// let slower = RankSum::new(0.9).ratio(&[1.0, 1.1, 1.2, 1.3], &[2.0, 2.2, 2.4, 2.6]).unwrap();
    /// assert!(slower.interval.contains(2.0));
    /// ```
    pub fn ratio(&self, old: &[f64], new: &[f64]) -> Option<Estimate> {
        let positive = |values: &[f64]| all_finite(values) && values.iter().all(|value| *value > 0.0);
        let fits = |values: &[f64]| (2..=MOST).contains(&values.len()) && positive(values);
        if !fits(old) || !fits(new) || !is_level(self.level) {
            return None;
        }
        let ratios: Vec<f64> = new.iter().flat_map(|new| old.iter().map(move |old| new / old)).collect();
        let ordered = sorted(&ratios)?;
        let sizes = (old.len(), new.len());
        let (rank, reached) =
            *self.ranks.borrow_mut().entry(sizes).or_insert_with(|| rank(sizes.0, sizes.1, self.level));
        let (low, high) = (ordered[rank - 1], *ordered.iter().nth_back(rank - 1)?);
        let interval = Interval::between(low, high, reached)?;
        Some(Estimate { value: quantile_of_sorted(&ordered, 0.5)?, interval })
    }

    /// The same for values in the order of their measurement, which may depend on their neighbours: the interval's ends
    /// are farther from the estimate, as logarithms, by the [`widening`] for both series. That factor may be too small
    /// with the probability with which an interval of this level misses, so the confidence falls by it.
    pub fn ratio_of_series(&self, old: &[f64], new: &[f64]) -> Option<Estimate> {
        let Estimate { value, interval } = self.ratio(old, new)?;
        let miss = 1.0 - self.level;
        let logarithms = [old, new].map(|values| values.iter().map(|value| libm::log(*value)).collect::<Vec<_>>());
        let factor = widening([&logarithms[0], &logarithms[1]], miss)?;
        let widened = |end: f64| value * libm::pow(end / value, factor);
        let interval = Interval::between(widened(interval.low), widened(interval.high), interval.level - miss)?;
        Some(Estimate { value, interval })
    }
}

/// The rank of the interval's ends, counted from 1 from either end of the ordered ratios, and the interval's
/// confidence.
fn rank(m: usize, n: usize, level: f64) -> (usize, f64) {
    let share = distribution(m, n);
    let (mut below, mut found) = (0.0, (1, 1.0 - 2.0 * share[0]));
    for (u, share) in share.iter().enumerate() {
        below += share;
        let reached = 1.0 - 2.0 * below;
        if reached < level {
            break;
        }
        found = (u + 1, reached);
    }
    found
}

/// The probability of each value of U between samples of m and n values from one distribution without ties: the share
/// of the ways to draw m of m + n ranks that have the rank sum of this U.
fn distribution(m: usize, n: usize) -> Vec<f64> {
    // shares[k][u]: the probability that k of the ranks seen so far are drawn, with u values of the other sample below
    // them. Counts of ways would overflow. Each step draws the next rank with its conditional probability.
    let mut shares = vec![vec![0.0; m * n + 1]; m + 1];
    shares[0][0] = 1.0;
    for seen in 0..m + n {
        let mut next = vec![vec![0.0; m * n + 1]; m + 1];
        for (drawn, row) in shares.iter().enumerate() {
            let Some(others) = seen.checked_sub(drawn).filter(|others| *others <= n) else { continue };
            let draw = (m - drawn) as f64 / (m + n - seen) as f64;
            for (u, share) in row.iter().enumerate().filter(|(_, share)| **share > 0.0) {
                if drawn < m {
                    next[drawn + 1][u + others] += share * draw;
                }
                if others < n {
                    next[drawn][u] += share * (1.0 - draw);
                }
            }
        }
        shares = next;
    }
    shares.swap_remove(m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Dxsm;

    /// Mann and Whitney's table, two-sided 5 %: the largest U at which equality is rejected.
    #[test]
    fn ranks_match_the_table_of_mann_and_whitney() {
        for (m, n, critical) in [(4, 4, 0), (5, 5, 2), (5, 8, 6), (8, 8, 13), (9, 9, 17), (10, 10, 23), (20, 20, 127)] {
            let (rank, reached) = rank(m, n, 0.95);
            assert_eq!(rank, critical + 1, "{m} and {n}");
            assert!((0.95..0.98).contains(&reached), "{m} and {n}: {reached}");
        }
        // Three and three values: the interval spans all ratios, and one draw in ten lies beyond it.
        let (rank, reached) = rank(3, 3, 0.95);
        assert!(rank == 1 && (reached - 0.9).abs() < 1e-12, "{rank} {reached}");
    }

    #[test]
    fn shares_add_up_and_are_symmetric() {
        for (m, n) in [(2, 3), (7, 4), (30, 30)] {
            let shares = distribution(m, n);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            let mirrored = shares.iter().zip(shares.iter().rev());
            assert!(mirrored.into_iter().all(|(a, b)| (a - b).abs() < 1e-12));
        }
        // Two of five ranks: ten draws, of which U = 0, 1, 2, 3, 4, 5, 6 take 1, 1, 2, 2, 2, 1, 1.
        let expected = [1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0].map(|ways| ways / 10.0);
        assert!(distribution(2, 3).iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12));
    }

    fn uniform(random: &mut Pcg64Dxsm) -> f64 {
        (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// The times of 4000 pairs of samples scatter strongly to one side. The interval contains the factor with the
    /// stated confidence, within four standard errors in either direction.
    #[test]
    fn coverage_is_as_stated() {
        const TRIALS: u32 = 4000;
        let mut random = Pcg64Dxsm::seed_from_u64(7);
        let mut times = |count: usize, factor: f64| -> Vec<f64> {
            (0..count).map(|_| factor * (1.0 + 0.1 * -libm::log(1.0 - uniform(&mut random)))).collect()
        };
        let intervals = RankSum::new(0.9);
        for (m, n) in [(5, 5), (9, 7)] {
            let (mut held, mut stated) = (0, 0.0);
            for _ in 0..TRIALS {
                let (old, new) = (times(m, 1.0), times(n, 1.3));
                let found = intervals.ratio(&old, &new).unwrap();
                held += u32::from(found.interval.contains(1.3));
                stated = found.interval.level;
            }
            let (share, error) =
                (f64::from(held) / f64::from(TRIALS), (stated * (1.0 - stated) / f64::from(TRIALS)).sqrt());
            assert!((share - stated).abs() < 4.0 * error, "{share} instead of {stated}");
        }
    }

    #[test]
    fn invalid_times_have_no_ratio() {
        for (old, new) in
            [(vec![1.0], vec![1.0, 2.0]), (vec![1.0, 0.0], vec![1.0, 2.0]), (vec![1.0, f64::NAN], vec![1.0; 2])]
        {
            assert_eq!(RankSum::new(0.95).ratio(&old, &new), None);
        }
        assert_eq!(RankSum::new(1.0).ratio(&[1.0, 2.0], &[1.0, 2.0]), None);
        let ties = RankSum::new(0.95).ratio(&[2.0; 6], &[3.0; 6]).unwrap();
        assert_eq!((ties.value, ties.interval.low, ties.interval.high), (1.5, 1.5, 1.5));
    }

    /// The ends move by the factor as logarithms: with alternating times, which are no more alike than independent
    /// ones, they stay.
    #[test]
    fn the_interval_of_series_contains_the_interval_of_samples() {
        let intervals = RankSum::new(0.975);
        let turns: [f64; 8] = std::array::from_fn(|at| [1.0, 1.1][at % 2] + 1e-3 * at as f64);
        let waves = [1.0, 1.1, 1.3, 1.4, 1.4, 1.3, 1.1, 1.0];
        let [sample, series] =
            [intervals.ratio(&turns, &turns), intervals.ratio_of_series(&turns, &turns)].map(Option::unwrap);
        assert!((series.interval.low - sample.interval.low).abs() < 1e-12 && series.interval.level >= 0.95);
        let [sample, series] =
            [intervals.ratio(&waves, &waves), intervals.ratio_of_series(&waves, &waves)].map(Option::unwrap);
        let moved = libm::log(series.interval.high / series.value) / libm::log(sample.interval.high / sample.value);
        let logarithms = waves.map(libm::log);
        assert!((moved - widening([&logarithms, &logarithms], 0.025).unwrap()).abs() < 1e-9, "{moved}");
    }
}
