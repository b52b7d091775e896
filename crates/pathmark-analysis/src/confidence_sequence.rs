//! Confidence sequences for a median: all their intervals hold together, so that sampling may stop after any value.
//!
//! If m is the median, each value is above m with probability 1/2 at most, whatever the values before it. A bet on
//! "above", with shares drawn uniformly from (1/2, 1], turns one unit into
//!
//! M = 2 (n + 1)^-1 P(B' <= s) / P(B = s),
//!
//! where s of n values are above m, B is binomial (n, 1/2) and B' is binomial (n + 1, 1/2). M is a supermartingale, so
//! the probability that it ever reaches 2 / miss is at most miss / 2 (J. Ville, 1939). The values m at which neither
//! the bet on "above" nor the bet on "below" has reached it lie between two order statistics. This is the mixture of H.
//! Robbins ("Statistical methods related to the law of the iterated logarithm", 1970) for the sign test. S. R. Howard
//! and A. Ramdas (2022, "Sequential estimation of quantiles with applications to A/B testing and best-arm
//! identification") have it as the beta-binomial boundary. Their closed form beside it needs about three times as many
//! values for an interval of the same ranks.

use super::interval::{Interval, is_level};
use super::quantile::{median_interval, sorted};

/// The fewest values for which an interval at every look exists at 95 %.
pub(super) const FEWEST: usize = 8;

/// How the number of values was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stopping {
    /// Before the first value.
    #[default]
    Fixed,
    /// From the values themselves.
    Sequential,
}

impl Stopping {
    /// Returns the interval of the median for a number of values chosen in this way: of order statistics, or one that
    /// holds at every look.
    pub fn median_interval(self, values: &[f64], level: f64) -> Option<Interval> {
        match self {
            Self::Fixed => median_interval(values, level),
            // So few values cannot decide when to stop, so their number did not depend on them.
            Self::Sequential if values.len() < FEWEST => median_interval(values, level),
            Self::Sequential => median_sequence(values, level),
        }
    }
}

/// Returns the interval of the median after these values. With probability `level`, the intervals after every number of
/// values contain the true median. `None` while there are too few values for two ends (seven or fewer at 95 %), and for
/// a value that is not finite.
///
/// It assumes that no value predicts whether the next one is above the median.
///
/// ```
/// use pathmark_analysis::confidence_sequence::median_sequence;
/// let values: Vec<f64> = (1..=20).map(f64::from).collect();
/// let interval = median_sequence(&values, 0.95).unwrap();
/// assert_eq!((interval.low, interval.high), (4.0, 17.0));
/// assert_eq!(median_sequence(&values[..7], 0.95), None);
/// ```
pub fn median_sequence(values: &[f64], level: f64) -> Option<Interval> {
    let ordered = sorted(values).filter(|_| is_level(level))?;
    let rank = rank(ordered.len(), level)?;
    Interval::between(ordered[ordered.len() - rank], ordered[rank - 1], level)
}

/// The least number of values on one side of a point that excludes the point as the median; `None` if even all `n` do
/// not.
fn rank(n: usize, level: f64) -> Option<usize> {
    let enough = 2.0 / (1.0 - level);
    let count = n as f64;
    // ln P(B = s) and P(B' > s), from s = n downwards.
    let mut share = -count * std::f64::consts::LN_2;
    let mut tail = libm::exp(share - std::f64::consts::LN_2);
    let mut found = None;
    for s in (n / 2 + 1..=n).rev() {
        let stake = 2.0 * (1.0 - tail) / (count + 1.0) * libm::exp(-share);
        if stake < enough {
            break;
        }
        found = Some(s);
        // P(B' = s) is P(B = s) (n + 1) / (2 (n + 1 - s)).
        let left = count + 1.0 - s as f64;
        tail += libm::exp(share) * (count + 1.0) / (2.0 * left);
        share += libm::log(s as f64 / left);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    const LEVEL: f64 = 0.95;

    /// Seven values cannot have decided when to stop; eight can.
    #[test]
    fn a_number_of_values_that_no_look_can_have_chosen_is_fixed() {
        let values: Vec<f64> = (0..9).map(f64::from).collect();
        let interval = |stopping: Stopping, count: usize, level: f64| stopping.median_interval(&values[..count], level);
        for count in 0..=7 {
            assert_eq!(interval(Stopping::Sequential, count, LEVEL), interval(Stopping::Fixed, count, LEVEL));
        }
        assert!(rank(FEWEST, LEVEL).is_some() && rank(FEWEST - 1, LEVEL).is_none());
        assert_eq!(interval(Stopping::Sequential, 8, 0.99), None);
        let [fixed, sequential] =
            [Stopping::Fixed, Stopping::Sequential].map(|stopping| interval(stopping, 9, LEVEL).unwrap());
        assert!(sequential.low < fixed.low && fixed.high < sequential.high);
    }

    /// Expected ranks from another program, which integrates the bets over their shares by the midpoint rule.
    #[test]
    fn ranks_are_those_of_the_integral() {
        let expected = [(6, None), (7, None), (8, Some(8)), (10, Some(10)), (12, Some(11)), (16, Some(14))];
        let larger = [(20, Some(17)), (30, Some(24)), (50, Some(36)), (100, Some(66)), (200, Some(124))];
        for (n, rank_of) in expected.into_iter().chain(larger) {
            assert_eq!(rank(n, LEVEL), rank_of, "{n}");
        }
        // Here 2^-n underflows.
        let many = rank(5000, LEVEL).unwrap() as f64;
        assert!((2500.0 + 2.0 * 35.4..2500.0 + 4.0 * 35.4).contains(&many), "{many}");
        assert!(median_sequence(&[1.0; 9], 1.0).is_none() && median_sequence(&[f64::NAN; 9], LEVEL).is_none());
        assert!(median_sequence(&[], LEVEL).is_none());
        let ties = median_sequence(&[3.0; 9], LEVEL).unwrap();
        assert_eq!((ties.low, ties.high), (3.0, 3.0));
    }

    fn uniform(generator: &mut Pcg64Dxsm) -> f64 {
        ((generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    }

    /// Returns in how many of 1000 sequences an interval misses the median at any look. A sequence has 120 values with
    /// median 0.
    fn misses(next: impl Fn(&mut Pcg64Dxsm, f64) -> f64, interval: fn(&[f64], f64) -> Option<Interval>) -> u32 {
        let mut generator = Pcg64Dxsm::new(5, 9);
        let mut missed = 0;
        for _ in 0..1000 {
            let (mut values, mut last) = (Vec::new(), 0.0);
            missed += u32::from((0..120).any(|_| {
                last = next(&mut generator, last);
                values.push(last);
                interval(&values, LEVEL).is_some_and(|interval| !interval.contains(0.0))
            }));
        }
        missed
    }

    fn logistic(generator: &mut Pcg64Dxsm) -> f64 {
        let u = uniform(generator);
        libm::log(u / (1.0 - u))
    }

    /// At most 5 % of the sequences ever miss, 50 of 1000; four standard deviations of that count are 28. Fewer than
    /// one in 200 would be implausible.
    #[test]
    fn the_median_is_held_at_every_look() {
        let cauchy = |g: &mut Pcg64Dxsm, _| {
            let u = uniform(g);
            (u - 0.5) / (u * (1.0 - u))
        };
        let two_heaps = |g: &mut Pcg64Dxsm, _| logistic(g) * 0.1 + if uniform(g) < 0.5 { -1.0 } else { 1.0 };
        let found = [
            misses(|g, _| logistic(g), median_sequence),
            misses(cauchy, median_sequence),
            misses(two_heaps, median_sequence),
        ];
        println!("missed by any of 120 looks: {found:?} of 1000");
        assert!(found.iter().all(|count| (5..78).contains(count)), "{found:?}");
        // An interval for one look misses several times as often if it is used at every look.
        let fixed = misses(|g, _| logistic(g), median_interval);
        assert!(fixed > 200, "{fixed}");
    }

    /// Dependent values break the assumption: with half of each value carried over (autocorrelation 1/2), a quarter of
    /// the sequences miss.
    #[test]
    fn values_that_hang_together_are_held_less_often() {
        let found = misses(|g, last| 0.5 * last + logistic(g), median_sequence);
        println!("autocorrelation 1/2: missed {found} of 1000");
        assert!(found > 78, "{found}");
    }
}
