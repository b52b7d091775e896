//! Whether two measurements of one value are equivalent: their difference, with Welch's degrees of freedom, against a limit.
//!
//! Both one-sided tests reject a difference beyond the limit exactly if the whole interval lies within it (D. J. Schuirmann,
//! "A comparison of the two one-sided tests procedure ...", 1987). Several statements share one level by Bonferroni's
//! inequality, which the caller applies.

use super::bisection::smallest;
use super::interval::{Estimate, Interval};
use super::mean::{Moments, fractional_t_quantile};

/// A value with its error, for Student's t: the logarithm of a ratio, or an exponent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    pub value: f64,
    pub standard_error: f64,
    pub degrees_of_freedom: f64,
    /// The independent values behind it: processes or seeds.
    pub units: usize,
}

impl Measured {
    /// The mean of independent values; `None` below two values or with one that is not finite.
    pub(crate) fn of_mean(values: &[f64]) -> Option<Self> {
        let moments = Moments::of(values);
        let (standard_error, degrees_of_freedom) = (moments.standard_error()?, values.len() as f64 - 1.0);
        Some(Self { value: moments.mean()?, standard_error, degrees_of_freedom, units: values.len() })
    }

    pub(crate) fn has_spread(&self) -> bool {
        self.standard_error > 0.0
    }

    /// The difference of two independent values, with Welch's degrees of freedom.
    pub(crate) fn minus(self, other: Self) -> Self {
        let [a, b] = [self, other].map(|own| own.standard_error * own.standard_error);
        Self {
            value: self.value - other.value,
            standard_error: (a + b).sqrt(),
            degrees_of_freedom: (a + b) * (a + b)
                / (a * a / self.degrees_of_freedom + b * b / other.degrees_of_freedom),
            units: self.units + other.units,
        }
    }

    /// The value with its two-sided interval; `None` for a level that is none.
    pub(crate) fn estimate(&self, level: f64) -> Option<Estimate> {
        let interval = Interval::around(self.value, self.half_width(level)?, level)?;
        Some(Estimate { value: self.value, interval })
    }

    /// Half of the two-sided interval; `None` for a level that is none.
    pub fn half_width(&self, level: f64) -> Option<f64> {
        Some(fractional_t_quantile(level, self.degrees_of_freedom)? * self.standard_error)
    }
}

/// How two measurements of one value compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equivalence {
    /// They differ by less than the limit.
    Equivalent,
    /// They differ by more than the limit.
    Different,
    /// The interval of their difference reaches across the limit.
    Open,
}

/// Compares a value with an earlier one. `limit` is the largest difference that counts as equal. Returns the later value less
/// the earlier one with the ends of its interval, and the verdict; `None` for a level or a limit that is none.
pub fn equivalence(earlier: Measured, later: Measured, limit: f64, level: f64) -> Option<([f64; 3], Equivalence)> {
    let difference = later.minus(earlier);
    let (value, half) = (difference.value, difference.half_width(level)?);
    let limit = Some(limit).filter(|limit| *limit > 0.0 && limit.is_finite())?;
    let verdict = if value.abs() + half <= limit {
        Equivalence::Equivalent
    } else if value.abs() - half > limit {
        Equivalence::Different
    } else {
        Equivalence::Open
    };
    Some(([value, value - half, value + half], verdict))
}

/// How many more values of the later measurement would tell, if the difference stays; `None` if the earlier one alone is too
/// uncertain, or the difference lies at the limit.
pub fn more_units(earlier: Measured, later: Measured, limit: f64, level: f64) -> Option<usize> {
    let deviation = later.standard_error * (later.units as f64).sqrt();
    let with = |units: usize| Measured {
        standard_error: deviation / (units as f64).sqrt(),
        degrees_of_freedom: units as f64 - 1.0,
        units,
        ..later
    };
    let tells = |more: usize| {
        equivalence(earlier, with(later.units + more), limit, level)
            .is_some_and(|(_, verdict)| verdict != Equivalence::Open)
    };
    smallest(0, 1 << 12, tells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adjacent_pairs::log_ratio;

    /// Two of three processes each: errors d / √3, so the difference has d √(2/3) and four degrees of freedom, t = 2.77645.
    #[test]
    fn the_difference_has_welchs_interval() {
        let d = 0.01;
        let of = |centre: f64| log_ratio(&[-d, 0.0, d].map(|own| vec![libm::exp(centre + own)])).unwrap();
        let half = 2.776_445 * d * (2.0_f64 / 3.0).sqrt();
        let limit = libm::log(1.1);
        for (shift, expected) in [
            (0.0, Equivalence::Equivalent),
            (limit - 1.01 * half, Equivalence::Equivalent),
            (limit, Equivalence::Open),
            (limit + 1.01 * half, Equivalence::Different),
            (-limit - 1.01 * half, Equivalence::Different),
        ] {
            let ([value, low, high], verdict) = equivalence(of(0.3), of(0.3 + shift), limit, 0.95).unwrap();
            assert_eq!(verdict, expected, "{shift}");
            assert!((value - shift).abs() < 1e-12);
            assert!((high - low - 2.0 * half).abs() < 1e-6);
        }
        assert_eq!(equivalence(of(0.0), of(0.0), 0.0, 0.95), None);
        assert_eq!(equivalence(of(0.0), of(0.0), 0.1, 1.0), None);
    }

    /// With as many more processes the verdict is there, with one less it is not.
    #[test]
    fn as_many_processes_as_a_verdict_needs() {
        let of = |units: usize, spread: f64, value: f64| Measured {
            value,
            standard_error: spread / (units as f64).sqrt(),
            degrees_of_freedom: units as f64 - 1.0,
            units,
        };
        let (earlier, later, limit) = (of(200, 0.02, 0.0), of(3, 0.1, 0.03), libm::log(1.1));
        let more = more_units(earlier, later, limit, 0.95).unwrap();
        let told = |more: usize| equivalence(earlier, of(3 + more, 0.1, 0.03), limit, 0.95).unwrap().1;
        assert_eq!((told(more), told(more - 1)), (Equivalence::Equivalent, Equivalence::Open));
        assert_eq!(more_units(of(3, 0.2, 0.0), later, limit, 0.95), None);
    }

    /// The mean of 1, 2 and 3 is 2, with the error 1 / √3 and t = 4.30265.
    #[test]
    fn a_mean_has_students_interval() {
        let found = Measured::of_mean(&[1.0, 2.0, 3.0]).unwrap();
        assert_eq!((found.value, found.degrees_of_freedom, found.units), (2.0, 2.0, 3));
        assert!((found.half_width(0.95).unwrap() - 4.302_653 / 3.0_f64.sqrt()).abs() < 1e-5);
        assert_eq!(found.half_width(0.0), None);
        for wrong in [[1.0].as_slice(), &[1.0, f64::NAN]] {
            assert_eq!(Measured::of_mean(wrong), None);
        }
    }
}
