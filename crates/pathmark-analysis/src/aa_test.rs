//! A/A tests: whether intervals miss as often as their level states. A configuration is compared with itself many times
//! (A against A), so the true ratio is 1, and one in twenty intervals of level 0.95 should miss it.
//!
//! The number of misses is a sum of independent trials, each with probability 1 - level. It is binomial if all levels
//! are equal, and Poisson-binomial (S. D. Poisson 1837) if they differ, as the levels of order statistics do. Its
//! distribution is computed exactly. Too few misses are as suspicious as too many: the intervals are then wider than
//! stated and hide effects.

use std::fmt;

use super::interval::is_level;

/// One comparison of a configuration with itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// The stated confidence of its interval.
    pub level: f64,
    /// Whether the interval contains 1, the true ratio.
    pub contains_truth: bool,
}

/// The verdict on the intervals after many comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The number of misses is compatible with the stated levels.
    AsStated,
    /// More misses than the levels allow: the intervals are too narrow, or the pairs are not alike.
    TooMany,
    /// Fewer misses than the levels promise: the intervals are too wide.
    TooFew,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AsStated => "as often as stated",
            Self::TooMany => "too often: the intervals are too narrow, or the pairs are not alike",
            Self::TooFew => "too seldom: the intervals are wider than they say",
        })
    }
}

/// The number of misses, and whether the stated levels explain it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    pub comparisons: usize,
    /// Expected number of misses, by the levels.
    pub expected: f64,
    pub found: usize,
    /// Two-sided: twice the probability of a number of misses at least as extreme on the same side, at most 1.
    pub p_value: f64,
    pub verdict: Verdict,
}

/// Compares the number of misses with the stated levels at significance `alpha`; `None` without comparisons or for a level outside (0, 1).
///
/// A small number of comparisons can't have too few misses: at 0.95 and `alpha` 0.05, zero misses are suspicious from
/// 72 comparisons on.
pub fn calibration(comparisons: &[Comparison], alpha: f64) -> Option<Calibration> {
    if comparisons.is_empty() || !is_level(alpha) || comparisons.iter().any(|comparison| !is_level(comparison.level)) {
        return None;
    }
    // chances[k]: the probability of k misses among the comparisons so far.
    let mut chances = vec![1.0];
    for miss in comparisons.iter().map(|comparison| 1.0 - comparison.level) {
        chances.push(0.0);
        for k in (0..chances.len()).rev() {
            let from_below = if k > 0 { chances[k - 1] * miss } else { 0.0 };
            chances[k] = chances[k] * (1.0 - miss) + from_below;
        }
    }
    let found = comparisons.iter().filter(|comparison| !comparison.contains_truth).count();
    let (at_most, at_least) = (chances[..=found].iter().sum::<f64>(), chances[found..].iter().sum::<f64>());
    let p_value = (2.0 * at_most.min(at_least)).min(1.0);
    let verdict = match p_value < alpha {
        false => Verdict::AsStated,
        true if at_least < at_most => Verdict::TooMany,
        true => Verdict::TooFew,
    };
    let expected = comparisons.iter().map(|comparison| 1.0 - comparison.level).sum();
    Some(Calibration { comparisons: comparisons.len(), expected, found, p_value, verdict })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `n` comparisons at one level, the first `misses` of which miss.
    fn many(n: usize, misses: usize, level: f64) -> Vec<Comparison> {
        (0..n).map(|i| Comparison { level, contains_truth: i >= misses }).collect()
    }

    #[test]
    fn binomial_tails_of_the_table() {
        // R: pbinom(0, 100, 0.05) = 0.005920529; pbinom(9, 100, 0.05, lower.tail = FALSE) = 0.02818829.
        let none = calibration(&many(100, 0, 0.95), 0.05).unwrap();
        assert!((none.p_value - 2.0 * 0.005_920_529).abs() < 1e-8 && none.verdict == Verdict::TooFew);
        let ten = calibration(&many(100, 10, 0.95), 0.05).unwrap();
        assert!((ten.p_value - 2.0 * 0.028_188_29).abs() < 1e-7 && ten.verdict == Verdict::AsStated);
        assert_eq!(calibration(&many(100, 11, 0.95), 0.05).unwrap().verdict, Verdict::TooMany);
        let five = calibration(&many(100, 5, 0.95), 0.05).unwrap();
        assert!((five.expected - 5.0).abs() < 1e-9 && five.found == 5 && five.p_value > 0.99);
    }

    #[test]
    fn no_miss_is_suspicious_from_seventy_two_on() {
        assert_eq!(calibration(&many(71, 0, 0.95), 0.05).unwrap().verdict, Verdict::AsStated);
        assert_eq!(calibration(&many(72, 0, 0.95), 0.05).unwrap().verdict, Verdict::TooFew);
    }

    #[test]
    fn levels_may_differ() {
        // Both comparisons miss, with probabilities 0.5 and 0.1: 0.05 on the upper side.
        let pair = [Comparison { level: 0.5, contains_truth: false }, Comparison { level: 0.9, contains_truth: false }];
        let both = calibration(&pair, 0.2).unwrap();
        assert!((both.p_value - 0.1).abs() < 1e-12 && (both.expected - 0.6).abs() < 1e-12);
        assert_eq!(both.verdict, Verdict::TooMany);
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(calibration(&[], 0.05), None);
        assert_eq!(calibration(&many(3, 0, 1.0), 0.05), None);
        assert_eq!(calibration(&many(3, 0, f64::NAN), 0.05), None);
        assert_eq!(calibration(&many(3, 0, 0.95), 0.0), None);
    }
}
