//! Gain from more workers: speedup, efficiency, and the serial fraction that would explain them.
//!
//! Karp-Flatt: A. H. Karp and H. P. Flatt, "Measuring parallel processor performance", Communications of the ACM 33(5), 1990,
//! e = (1/S - 1/p) / (1 - 1/p), here from times in seconds. Constant e over p means serial work; growing e means overhead.
//!
//! A work-conserving schedule on p equal cores can't be more than p times as fast as the best serial program (V. Faber,
//! O. M. Lubeck and A. B. White, "Superlinear speedup of an efficient sequential algorithm is not possible", Parallel
//! Computing 3, 1986). A speedup above p therefore shows that something else differed between the two runs. The first
//! cause with evidence is named; none is guessed.

use std::fmt;

use super::interval::{Estimate, Interval};

/// S = T1 / Tp, from times in seconds; `None` unless both are positive and finite.
pub fn speedup(serial_s: f64, parallel_s: f64) -> Option<f64> {
    let ratio = serial_s / parallel_s;
    (serial_s > 0.0 && parallel_s > 0.0 && ratio > 0.0 && ratio.is_finite()).then_some(ratio)
}

/// E = S / p; `None` for p = 0 or a speedup that is not positive and finite.
pub fn efficiency(speedup: f64, workers: usize) -> Option<f64> {
    (workers > 0 && speedup > 0.0 && speedup.is_finite()).then(|| speedup / workers as f64)
}

/// The experimentally determined serial fraction e; `None` for fewer than two workers, where it does not exist.
///
/// It is negative for a superlinear speedup and above 1 for a slowdown: both are findings to be explained, not errors.
pub fn serial_fraction(speedup: f64, workers: usize) -> Option<f64> {
    if workers < 2 || !(speedup > 0.0 && speedup.is_finite()) {
        return None;
    }
    let share = 1.0 / workers as f64;
    let fraction = (1.0 / speedup - share) / (1.0 - share);
    fraction.is_finite().then_some(fraction)
}

/// The serial fraction of a speedup that is known within an interval; `None` where an end has no fraction. The fraction
/// falls with the speedup, so the ends of its interval have the same confidence.
pub fn serial_fraction_within(speedup: &Estimate, workers: usize) -> Option<Estimate> {
    let of = |speedup: f64| serial_fraction(speedup, workers);
    let Estimate { value, interval: Interval { low, high, level } } = *speedup;
    Some(Estimate { value: of(value)?, interval: Interval::between(of(high)?, of(low)?, level)? })
}

/// Whether S > p, which needs a cause: a cache that now fits, a higher clock, or a baseline that was built differently.
pub fn is_superlinear(speedup: f64, workers: usize) -> bool {
    speedup > workers as f64
}

/// An unusual speedup, which needs an explanation beside it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Oddity {
    /// The whole interval lies above the number of workers.
    Superlinear,
    /// The whole interval lies below 1.
    Slowdown,
}

/// Returns the oddity of a speedup, if any. It is judged by the whole interval, so noise alone seldom causes one.
pub fn oddity(speedup: &Interval, workers: usize) -> Option<Oddity> {
    if is_superlinear(speedup.low, workers) {
        Some(Oddity::Superlinear)
    } else if speedup.high < 1.0 {
        Some(Oddity::Slowdown)
    } else {
        None
    }
}

/// Evidence recorded beside a speedup.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evidence {
    /// Time of the serial baseline over the strategy's own time at one worker.
    pub at_one_worker: Option<Interval>,
    /// Number of warnings of the runs: load of other programs, changing clocks and the like.
    pub warnings: usize,
    /// Logical processors of the machine.
    pub processors: Option<usize>,
    pub physical_cores: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The strategy is already faster than the baseline at one worker.
    SlowBaseline,
    /// The runs carry warnings.
    Disturbance,
    /// Logical processors share cores.
    SharedCores,
    /// No recorded evidence explains it.
    Unexplained,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SlowBaseline => "likely cause: the baseline is slower than the strategy at one worker",
            Self::Disturbance => "likely cause: load of others or a changing clock, of which the runs carry warnings",
            Self::SharedCores => {
                "likely cause: processors share cores (SMT), so that the baseline may have had less than a core to itself"
            }
            Self::Unexplained => "unexplained: nothing that was recorded tells why",
        })
    }
}

/// Returns the first cause with evidence, with the strongest evidence first.
pub fn cause(evidence: &Evidence) -> Cause {
    let shared = evidence.processors.zip(evidence.physical_cores).is_some_and(|(logical, cores)| logical > cores);
    if evidence.at_one_worker.is_some_and(|speedup| speedup.low > 1.0) {
        Cause::SlowBaseline
    } else if evidence.warnings > 0 {
        Cause::Disturbance
    } else if shared {
        Cause::SharedCores
    } else {
        Cause::Unexplained
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantile::{median, median_interval};

    #[test]
    fn speedup_and_efficiency() {
        assert_eq!(speedup(12.0, 3.0), Some(4.0));
        assert_eq!(efficiency(4.0, 8), Some(0.5));
    }

    #[test]
    fn karp_flatt_returns_the_fraction_of_amdahls_law() {
        // S = 1 / (f + (1 - f) / p) (Amdahl 1967) put into Karp-Flatt gives f back.
        for fraction in [0.0, 0.01, 0.1, 0.5, 1.0] {
            for workers in [2_usize, 3, 8, 64] {
                let speedup = 1.0 / (fraction + (1.0 - fraction) / workers as f64);
                assert!((serial_fraction(speedup, workers).unwrap() - fraction).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn karp_flatt_on_a_textbook_row() {
        // M. J. Quinn, "Parallel Programming in C with MPI and OpenMP", 7.5: S = 4.71 at p = 8 has e = 0.1.
        assert!((serial_fraction(4.71, 8).unwrap() - 0.1).abs() < 5e-4);
    }

    #[test]
    fn interval_of_the_fraction_is_that_of_the_speedup_turned_round() {
        // Of nine values the second and the eighth enclose the median with 96.1 %; e falls with S, so they change places.
        let speedups = [1.7, 1.8, 1.9, 1.75, 1.85, 1.6, 1.95, 1.65, 1.78];
        let estimate = |speedups: &[f64]| Estimate {
            value: median(speedups).unwrap(),
            interval: median_interval(speedups, 0.95).unwrap(),
        };
        let fraction = serial_fraction_within(&estimate(&speedups), 2).unwrap();
        let of = |speedup: f64| 2.0 / speedup - 1.0;
        let ends = (fraction.interval.low, fraction.value, fraction.interval.high);
        for (end, speedup) in [(ends.0, 1.9), (ends.1, 1.78), (ends.2, 1.65)] {
            assert!((end - of(speedup)).abs() < 1e-12, "{ends:?}");
        }
        assert!((fraction.interval.level - 0.960_937_5).abs() < 1e-9);
        let equal = serial_fraction_within(&estimate(&[1.8, 1.8]), 2).unwrap();
        assert!(equal.interval.low == equal.interval.high && (equal.interval.level - 0.5).abs() < 1e-12);
        for (sample, workers) in [(&speedups[..], 1), (&[1.8, 0.0], 2)] {
            assert_eq!(serial_fraction_within(&estimate(sample), workers), None);
        }
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(speedup(0.0, 1.0), None);
        assert_eq!(speedup(1.0, 0.0), None);
        assert_eq!(speedup(f64::NAN, 1.0), None);
        assert_eq!(speedup(f64::INFINITY, 1.0), None);
        assert_eq!(efficiency(1.0, 0), None);
        assert_eq!(serial_fraction(1.0, 1), None);
        assert_eq!(serial_fraction(0.0, 4), None);
        assert_eq!(serial_fraction(f64::NAN, 4), None);
    }

    #[test]
    fn only_evidence_is_called_a_cause() {
        for cause in [Cause::SlowBaseline, Cause::Disturbance, Cause::SharedCores] {
            assert!(cause.to_string().starts_with("likely cause: "));
        }
        assert!(Cause::Unexplained.to_string().starts_with("unexplained"));
    }
}
