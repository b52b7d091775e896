//! Order statistics: quantiles, and the median with its interval.
//!
//! Quantiles interpolate linearly between neighbours at position (n - 1) q: type 7 of R. J. Hyndman and Y. Fan, "Sample quantiles
//! in statistical packages", The American Statistician 50 (1996). The interval of the median assumes nothing about the
//! distribution but independence: the number of values below the true median is binomial (n, 1/2), so the r-th smallest and the
//! r-th largest value enclose it with probability 1 - 2 P(B < r) (H. A. David and H. N. Nagaraja, "Order Statistics", 2003, 7.1).

use statrs::distribution::{Binomial, DiscreteCDF};

use super::interval::{Interval, all_finite, is_level};

/// The median; `None` for no values or one that is not finite.
///
/// ```
/// assert_eq!(pathmark_analysis::quantile::median(&[5.0, 1.0, 3.0]), Some(3.0));
/// assert_eq!(pathmark_analysis::quantile::median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
/// ```
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The `q`-quantile, `q` in [0, 1]; `None` for no values, one that is not finite, or another `q`.
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    quantile_of_sorted(&sorted(values)?, q)
}

/// The narrowest symmetric pair of order statistics that encloses the true median with at least `level` confidence.
///
/// With five or fewer values, even the extremes do not reach 95 %. They are then returned, and the interval's own
/// `level` gives the confidence reached: 93.75 % for five, 50 % for two. `None` below two values.
pub fn median_interval(values: &[f64], level: f64) -> Option<Interval> {
    let ordered = sorted(values)?;
    let (rank, reached) = median_rank(ordered.len(), level)?;
    Interval::between(ordered[rank - 1], ordered[ordered.len() - rank], reached)
}

/// The rank r, counted from 1, whose pair (r, n + 1 - r) makes the interval of the median, and the confidence it has.
fn median_rank(n: usize, level: f64) -> Option<(usize, f64)> {
    if n < 2 || !is_level(level) {
        return None;
    }
    let below = Binomial::new(0.5, n as u64).ok()?;
    let reached = |rank: usize| 1.0 - 2.0 * below.cdf(rank as u64 - 1);
    // Narrower pairs have less confidence, so the first one below `level` ends the search.
    let rank = (2..=n / 2).take_while(|&rank| reached(rank) >= level).last().unwrap_or(1);
    Some((rank, reached(rank)))
}

/// The values in ascending order; `None` if there are none or one is not finite.
pub(super) fn sorted(values: &[f64]) -> Option<Vec<f64>> {
    if values.is_empty() || !all_finite(values) {
        return None;
    }
    let mut ordered = values.to_vec();
    ordered.sort_by(f64::total_cmp);
    Some(ordered)
}

/// The quantile of values that are in ascending order already.
pub(super) fn quantile_of_sorted(ordered: &[f64], q: f64) -> Option<f64> {
    let last = ordered.len().checked_sub(1)?;
    if !(0.0..=1.0).contains(&q) {
        return None;
    }
    let position = last as f64 * q;
    let below = position.floor() as usize;
    let (low, high) = (ordered[below], ordered[(below + 1).min(last)]);
    let fraction = position - below as f64;
    // With these weights, two huge values of opposite sign don't overflow. The clamp returns equal neighbours
    // unchanged.
    Some((low * (1.0 - fraction) + high * fraction).clamp(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_of_odd_even_unsorted_and_single() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[10.0, 1.0, 3.0, 2.0]), Some(2.5));
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[-1e308, 1e308]), Some(0.0));
        assert_eq!(median(&[-0.0, 0.0, -5.0]), Some(0.0));
    }

    #[test]
    fn quantiles_are_of_type_seven() {
        // R: quantile(c(1, 2, 4, 8, 16), c(.1, .25, .9)) gives 1.4, 2, 12.8.
        let values = [16.0, 1.0, 4.0, 2.0, 8.0];
        for (q, expected) in [(0.0, 1.0), (0.1, 1.4), (0.25, 2.0), (0.5, 4.0), (0.9, 12.8), (1.0, 16.0)] {
            assert!((quantile(&values, q).unwrap() - expected).abs() < 1e-12, "{q}");
        }
    }

    #[test]
    fn ranks_of_the_median_interval_match_the_binomial_table() {
        let table = [(5, 1, 0.9375), (6, 1, 0.96875), (9, 2, 0.960_937_5), (10, 2, 0.978_515_625)];
        for (n, rank, level) in table {
            let (r, reached) = median_rank(n, 0.95).unwrap();
            assert_eq!(r, rank, "n = {n}");
            assert!((reached - level).abs() < 1e-9, "n = {n}: {reached}");
        }
        for (n, rank, level) in [(20, 6, 0.959), (30, 10, 0.957)] {
            let (r, reached) = median_rank(n, 0.95).unwrap();
            assert_eq!(r, rank, "n = {n}");
            assert!((reached - level).abs() < 5e-4, "n = {n}: {reached}");
        }
    }

    #[test]
    fn interval_takes_the_order_statistics() {
        let values: Vec<f64> = (1..=9).rev().map(f64::from).collect();
        let interval = median_interval(&values, 0.95).unwrap();
        assert_eq!((interval.low, interval.high), (2.0, 8.0));
        let few = median_interval(&[5.0, 1.0, 2.0, 4.0, 3.0], 0.95).unwrap();
        assert_eq!((few.low, few.high), (1.0, 5.0));
        assert!((few.level - 0.9375).abs() < 1e-12);
        assert!((median_interval(&[2.0, 1.0], 0.95).unwrap().level - 0.5).abs() < 1e-12);
        assert_eq!(median_interval(&[3.0; 6], 0.95).map(|i| (i.low, i.high)), Some((3.0, 3.0)));
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[1.0, f64::NAN]), None);
        assert_eq!(median(&[f64::INFINITY, 1.0, 2.0]), None);
        assert_eq!(quantile(&[1.0], 1.5), None);
        assert_eq!(quantile(&[1.0], f64::NAN), None);
        assert_eq!(median_interval(&[1.0], 0.95), None);
        assert_eq!(median_interval(&[1.0, 2.0, 3.0], 1.0), None);
    }
}
