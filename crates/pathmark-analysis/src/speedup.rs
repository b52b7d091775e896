//! Gain from more workers: speedup, efficiency, and the serial fraction that would explain them.
//!
//! Karp-Flatt: A. H. Karp and H. P. Flatt, "Measuring parallel processor performance", Communications of the ACM 33(5), 1990,
//! e = (1/S - 1/p) / (1 - 1/p), here from times in seconds. Constant e over p means serial work; growing e means overhead.

use serde::Serialize;

use super::interval::{Estimate, Interval};
use super::quantile::{median, median_interval};

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

/// Returns the serial fraction of the median of `speedups`, one for each pair of runs measured side by side. The
/// fraction falls with the speedup. The order statistics that enclose the median speedup therefore give ends that
/// enclose the fraction with the same confidence.
///
/// `None` for fewer than two workers or two speedups, or one that is not positive and finite.
pub fn serial_fraction_estimate(speedups: &[f64], workers: usize, level: f64) -> Option<Estimate> {
    if speedups.iter().any(|&speedup| !(speedup > 0.0 && speedup.is_finite())) {
        return None;
    }
    serial_fraction_within(&Estimate { value: median(speedups)?, interval: median_interval(speedups, level)? }, workers)
}

/// The serial fraction of a speedup that is known within an interval; `None` where an end has no fraction.
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
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

#[cfg(test)]
mod tests {
    use super::*;

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
        let fraction = serial_fraction_estimate(&speedups, 2, 0.95).unwrap();
        let of = |speedup: f64| 2.0 / speedup - 1.0;
        let ends = (fraction.interval.low, fraction.value, fraction.interval.high);
        for (end, speedup) in [(ends.0, 1.9), (ends.1, 1.78), (ends.2, 1.65)] {
            assert!((end - of(speedup)).abs() < 1e-12, "{ends:?}");
        }
        assert!((fraction.interval.level - 0.960_937_5).abs() < 1e-9);
        let equal = serial_fraction_estimate(&[1.8, 1.8], 2, 0.95).unwrap();
        assert!(equal.interval.low == equal.interval.high && (equal.interval.level - 0.5).abs() < 1e-12);
        for (sample, workers) in [(&speedups[..], 1), (&speedups[..1], 2), (&[1.8, 0.0], 2)] {
            assert_eq!(serial_fraction_estimate(sample, workers, 0.95), None);
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
}
