//! Rank correlation: whether two properties of the same items rise together, by their ranks only.

use super::interval::all_finite;
use statrs::distribution::{ContinuousCDF, Normal};

/// Spearman's rank correlation and its p-value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankCorrelation {
    /// From -1 (one falls where the other rises) to 1.
    pub rho: f64,
    /// Two-sided p-value: the share of all orders of one property whose correlation is at least as far from 0. Exact up
    /// to [`EXACT`] values; above, from the normal approximation of variance 1/(n - 1).
    pub p: f64,
}

/// The largest number of values for which all orders are tried.
pub const EXACT: usize = 9;

/// Returns Spearman's rank correlation; equal values share their mean rank. `None` below three pairs, for a value that
/// is not finite, and if all values of one property are equal (C. Spearman, "The proof and measurement of association
/// between two things", American Journal of Psychology 15, 1904).
///
/// ```
/// use pathmark_analysis::rank::spearman;
/// let falling = spearman(&[(1.0, 9.0), (2.0, 7.0), (3.0, 1.0), (4.0, 0.5)]).unwrap();
/// // Of the 24 orders of four values only the two monotone ones are as far from 0.
/// assert_eq!((falling.rho, falling.p), (-1.0, 2.0 / 24.0));
/// ```
pub fn spearman(pairs: &[(f64, f64)]) -> Option<RankCorrelation> {
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.iter().copied().unzip();
    if pairs.len() < 3 || !all_finite(&x) || !all_finite(&y) {
        return None;
    }
    let (x, mut y) = (centred_ranks(&x), centred_ranks(&y));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let scale = (product(&x, &x) * product(&y, &y)).sqrt();
    if scale <= 0.0 {
        return None;
    }
    let found = product(&x, &y);
    let p = if pairs.len() <= EXACT {
        // Centred ranks are whole numbers, so their products are exact.
        let (mut orders, mut as_far) = (0u32, 0u32);
        every_order(&mut y, &mut |order| {
            orders += 1;
            as_far += u32::from(product(&x, order).abs() >= found.abs());
        });
        f64::from(as_far) / f64::from(orders)
    } else {
        let z = (found / scale).abs() * ((pairs.len() - 1) as f64).sqrt();
        2.0 * Normal::new(0.0, 1.0).ok()?.sf(z)
    };
    Some(RankCorrelation { rho: found / scale, p })
}

/// Returns twice the difference of each rank from the mean rank: whole numbers.
fn centred_ranks(values: &[f64]) -> Vec<f64> {
    let count = |is: &dyn Fn(f64) -> bool| values.iter().filter(|value| is(**value)).count() as f64;
    values.iter().map(|value| count(&|other| other < *value) - count(&|other| other > *value)).collect()
}

/// Calls `visit` with every order of the values (B. R. Heap, "Permutations by interchanges", The Computer Journal 6, 1963).
fn every_order(values: &mut [f64], visit: &mut impl FnMut(&[f64])) {
    let mut swaps = vec![0; values.len()];
    visit(values);
    let mut index = 1;
    while index < values.len() {
        if swaps[index] < index {
            values.swap(if index % 2 == 0 { 0 } else { swaps[index] }, index);
            visit(values);
            swaps[index] += 1;
            index = 1;
        } else {
            swaps[index] = 0;
            index += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without ties: 1 - 6 sum d²/(n (n² - 1)). Here d = (0, 1, -1, 0, 0), so rho = 1 - 12/120.
    #[test]
    fn it_is_the_formula_of_differences() {
        let found = spearman(&[(1.0, 10.0), (2.0, 30.0), (3.0, 20.0), (4.0, 40.0), (5.0, 50.0)]).unwrap();
        assert!((found.rho - 0.9).abs() < 1e-15);
        // At least as far from 0 are the two monotone orders and the four swaps of neighbours in each: 10 of 120.
        assert!((found.p - 10.0 / 120.0).abs() < 1e-15, "{}", found.p);
    }

    /// The two-sided 5 % point for n = 9 is 0.700 (J. H. Zar, "Biostatistical Analysis", table of critical values of Spearman's rho).
    #[test]
    fn exact_levels_are_those_of_the_tables() {
        let ranks = |order: [u32; 9]| (1..).zip(order).map(|(x, y)| (f64::from(x), f64::from(y))).collect::<Vec<_>>();
        // sum d² = 36 and 38: rho = 0.7 and 0.683.
        let at = spearman(&ranks([1, 2, 3, 4, 8, 9, 6, 7, 5])).unwrap();
        assert!((at.rho - 0.7).abs() < 1e-15 && at.p <= 0.05, "{at:?}");
        let below = spearman(&ranks([1, 2, 3, 4, 8, 9, 7, 6, 5])).unwrap();
        assert!((below.rho - 1.0 + 38.0 / 120.0).abs() < 1e-15 && below.p > 0.05, "{below:?}");
    }

    #[test]
    fn ties_share_a_rank_and_constant_values_have_none() {
        let tied = spearman(&[(1.0, 1.0), (1.0, 1.0), (2.0, 2.0)]).unwrap();
        assert!((tied.rho - 1.0).abs() < 1e-15);
        assert_eq!(spearman(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(spearman(&[(1.0, f64::NAN), (2.0, 2.0), (3.0, 3.0)]), None);
        assert_eq!(spearman(&[(1.0, 1.0), (2.0, 2.0)]), None);
    }
}
