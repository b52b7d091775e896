//! Whether two measurements of one ratio agree: the difference of their logarithms, with Welch's degrees of freedom, against
//! a margin.
//!
//! Both one-sided tests reject a difference beyond the margin exactly if the whole interval lies within it (D. J. Schuirmann,
//! "A comparison of the two one-sided tests procedure ...", 1987). Several statements share one level by Bonferroni's
//! inequality, which the caller applies.

use super::adjacent_pairs::log_ratio;
use super::mean::fractional_t_quantile;
use serde::Serialize;

/// The logarithm of a ratio with its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogRatio {
    pub value: f64,
    pub standard_error: f64,
    pub degrees_of_freedom: f64,
    /// Processes: the independent values.
    pub units: usize,
}

impl LogRatio {
    /// From the pairs of each process; see [`log_ratio`].
    pub fn of(processes: &[Vec<f64>]) -> Option<Self> {
        log_ratio(processes)
    }
}

/// The verdict of two measurements of a ratio.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    /// The ratios differ by less than the margin.
    Reproduced,
    /// They differ by more than the margin.
    NotReproduced,
    /// The interval of their ratio reaches across the margin.
    CannotTell,
}

/// Compares a ratio with an earlier one. `margin` is the largest ratio of both that counts as equal, such as 1.1. Returns the
/// ratio of the later to the earlier one with the ends of its interval, and the verdict; `None` for a level or a margin that is
/// none.
pub fn agreement(earlier: LogRatio, later: LogRatio, margin: f64, level: f64) -> Option<([f64; 3], Agreement)> {
    let [a, b] = [earlier, later].map(|own| own.standard_error * own.standard_error);
    let variance = a + b;
    let degrees = variance * variance / (a * a / earlier.degrees_of_freedom + b * b / later.degrees_of_freedom);
    let half = fractional_t_quantile(level, degrees)? * variance.sqrt();
    let difference = later.value - earlier.value;
    let limit = Some(libm::log(margin)).filter(|limit| *limit > 0.0 && limit.is_finite())?;
    let verdict = if difference.abs() + half <= limit {
        Agreement::Reproduced
    } else if difference.abs() - half > limit {
        Agreement::NotReproduced
    } else {
        Agreement::CannotTell
    };
    Some(([difference, difference - half, difference + half].map(libm::exp), verdict))
}

/// How many more processes of the later measurement would tell, if the difference stays; `None` if the earlier one alone is too
/// uncertain, or the difference lies at the margin.
pub fn more_processes(earlier: LogRatio, later: LogRatio, margin: f64, level: f64) -> Option<usize> {
    const MOST: usize = 1 << 12;
    let deviation = later.standard_error * (later.units as f64).sqrt();
    let with = |units: usize| LogRatio {
        standard_error: deviation / (units as f64).sqrt(),
        degrees_of_freedom: units as f64 - 1.0,
        units,
        ..later
    };
    let tells = |more: usize| {
        agreement(earlier, with(later.units + more), margin, level)
            .is_some_and(|(_, verdict)| verdict != Agreement::CannotTell)
    };
    let (mut few, mut many) = (0, MOST);
    if !tells(many) {
        return None;
    }
    while many - few > 1 {
        let middle = few.midpoint(many);
        if tells(middle) { many = middle } else { few = middle }
    }
    Some(many)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two of three processes each: errors d / √3, so the difference has d √(2/3) and four degrees of freedom, t = 2.77645.
    #[test]
    fn the_difference_has_welchs_interval() {
        let d = 0.01;
        let of = |centre: f64| LogRatio::of(&[-d, 0.0, d].map(|own| vec![libm::exp(centre + own)])).unwrap();
        let half = 2.776_445 * d * (2.0_f64 / 3.0).sqrt();
        for (shift, expected) in [
            (0.0, Agreement::Reproduced),
            (libm::log(1.1) - 1.01 * half, Agreement::Reproduced),
            (libm::log(1.1), Agreement::CannotTell),
            (libm::log(1.1) + 1.01 * half, Agreement::NotReproduced),
            (-libm::log(1.1) - 1.01 * half, Agreement::NotReproduced),
        ] {
            let ([value, low, high], verdict) = agreement(of(0.3), of(0.3 + shift), 1.1, 0.95).unwrap();
            assert_eq!(verdict, expected, "{shift}");
            assert!((libm::log(value) - shift).abs() < 1e-12);
            assert!((libm::log(high / low) - 2.0 * half).abs() < 1e-6);
        }
        assert_eq!(agreement(of(0.0), of(0.0), 1.0, 0.95), None);
        assert_eq!(agreement(of(0.0), of(0.0), 1.1, 1.0), None);
    }

    /// With as many more processes the verdict is there, with one less it is not.
    #[test]
    fn as_many_processes_as_a_verdict_needs() {
        let of = |units: usize, spread: f64, value: f64| LogRatio {
            value,
            standard_error: spread / (units as f64).sqrt(),
            degrees_of_freedom: units as f64 - 1.0,
            units,
        };
        let (earlier, later) = (of(200, 0.02, 0.0), of(3, 0.1, 0.03));
        let more = more_processes(earlier, later, 1.1, 0.95).unwrap();
        let told = |more: usize| agreement(earlier, of(3 + more, 0.1, 0.03), 1.1, 0.95).unwrap().1;
        assert_eq!((told(more), told(more - 1)), (Agreement::Reproduced, Agreement::CannotTell));
        assert_eq!(more_processes(of(3, 0.2, 0.0), later, 1.1, 0.95), None);
    }
}
