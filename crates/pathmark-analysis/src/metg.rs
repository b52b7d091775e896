//! METG(50 %): the smallest job duration at which a scheduler still reaches half of the ideal efficiency.
//!
//! E. Slaughter and others, "Task Bench: a parameterized benchmark for evaluating parallel runtime performance", SC
//! 2020: the minimum effective task granularity is the smallest duration of a job, in seconds, at which a scheduler
//! still reaches a given efficiency. Between two measured granularities, the efficiency is interpolated over the
//! logarithm of the duration. Efficiency should rise with the granularity. Noise or imbalance can let it cross the
//! target several times. The largest granularity at which it rises through the target is then used, the cautious
//! answer, and the result gives the number of crossings.

use super::bootstrap;
use super::interval::Interval;
use super::quantile::median;

/// The target efficiency of METG unless another one is given.
pub const HALF: f64 = 0.5;

/// Seconds per job, and the efficiency of each repetition. The median efficiency is used.
pub type Grain = (f64, Vec<f64>);

/// The minimum effective granularity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Metg {
    /// The efficiency rises through the target.
    Value {
        /// Seconds per job at which it does.
        seconds: f64,
        /// The bootstrap interval over the repetitions; `None` without repetitions, or if a resample does not rise
        /// through the target.
        interval: Option<Interval>,
        /// The measured granularities to either side.
        between: (f64, f64),
        /// Number of times that the efficiency crosses the target, in either direction. A report must state a number
        /// above 1.
        crossings: usize,
    },
    /// Even the smallest jobs measured, of this many seconds, reach the target.
    Below(f64),
    /// Even the largest jobs measured, of this many seconds, do not reach it.
    Above(f64),
    /// There is none, for this reason.
    Undefined(&'static str),
}

/// No granularity, one without an efficiency, a value that is not finite, or a duration that is not positive.
const NO_DATA: &str = "no usable measurement";
/// Small jobs reach the target and large ones do not.
const FALLING: &str = "efficiency only falls with the size of the jobs: there may be too few large ones to go round";

/// The METG of one strategy for efficiency `target`, from granularities in any order.
pub fn metg(grains: &[Grain], target: f64, level: f64) -> Metg {
    let Some((seconds, groups)) = prepared(grains) else { return Metg::Undefined(NO_DATA) };
    let found = crossing(&seconds, &groups, target);
    if let Some(Metg::Value { seconds: at, between, crossings, .. }) = found {
        // On the logarithmic scale of the interpolation.
        let resampled = bootstrap::of_groups(&groups, level, |groups| match crossing(&seconds, groups, target)? {
            Metg::Value { seconds, .. } => Some([libm::log(seconds)]),
            _ => None,
        });
        let interval = resampled.and_then(|[log]| Some(log.exp()?.interval));
        return Metg::Value { seconds: at, interval, between, crossings };
    }
    found.unwrap_or(Metg::Undefined(NO_DATA))
}

/// Granularities in ascending order, with equal ones merged, and their efficiencies; `None` if one is unusable.
fn prepared(grains: &[Grain]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
    let usable = |grain: &Grain| grain.0 > 0.0 && grain.0.is_finite() && median(&grain.1).is_some();
    if grains.is_empty() || !grains.iter().all(usable) {
        return None;
    }
    let mut ordered: Vec<Grain> = grains.to_vec();
    ordered.sort_by(|a, b| a.0.total_cmp(&b.0));
    ordered.dedup_by(|later, kept| {
        let same = later.0 == kept.0;
        if same {
            kept.1.append(&mut later.1);
        }
        same
    });
    Some(ordered.into_iter().unzip())
}

/// METG of granularities in ascending order, without an interval.
fn crossing(seconds: &[f64], groups: &[Vec<f64>], target: f64) -> Option<Metg> {
    let efficiency = groups.iter().map(|group| median(group)).collect::<Option<Vec<f64>>>()?;
    let reached: Vec<bool> = efficiency.iter().map(|&value| value >= target).collect();
    let crossings = reached.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let Some(below) = reached.windows(2).rposition(|pair| !pair[0] && pair[1]) else {
        return Some(match (crossings, reached.first()?) {
            (0, true) => Metg::Below(*seconds.first()?),
            (0, false) => Metg::Above(*seconds.last()?),
            _ => Metg::Undefined(FALLING),
        });
    };
    let between = (seconds[below], seconds[below + 1]);
    let share = (target - efficiency[below]) / (efficiency[below + 1] - efficiency[below]);
    let log = libm::log(between.0) + share * (libm::log(between.1) - libm::log(between.0));
    Some(Metg::Value { seconds: libm::exp(log), interval: None, between, crossings })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Granularities with one efficiency each.
    fn bare(points: &[(f64, f64)]) -> Vec<Grain> {
        points.iter().map(|&(seconds, efficiency)| (seconds, vec![efficiency])).collect()
    }

    #[test]
    fn interpolated_on_the_logarithm() {
        // 0.3 at 1 us and 0.7 at 100 us: half way on the logarithm is 10 us. The order of the points does not matter.
        let points = bare(&[(1e-2, 0.99), (1e-6, 0.3), (1e-4, 0.7)]);
        let Metg::Value { seconds, interval, between, crossings } = metg(&points, HALF, 0.95) else { panic!() };
        assert!((seconds - 1e-5).abs() < 1e-12);
        assert_eq!((interval, between, crossings), (None, (1e-6, 1e-4), 1));
    }

    #[test]
    fn overhead_model_gives_its_overhead_back() {
        // A job of g seconds with an overhead of o seconds has efficiency g / (g + o): one half at g = o.
        let overhead = 3e-6;
        let grid = (0..60).map(|i| 1e-7 * libm::pow(10.0, f64::from(i) / 12.0));
        let points: Vec<Grain> =
            grid.map(|g| (g, [0.99, 1.0, 1.01].map(|f| f * g / (g + overhead)).to_vec())).collect();
        let Metg::Value { seconds, interval, .. } = metg(&points, HALF, 0.95) else { panic!() };
        assert!((seconds / overhead - 1.0).abs() < 0.01, "{seconds}");
        let interval = interval.unwrap();
        assert!(interval.contains(overhead) && interval.high / interval.low < 1.2, "{interval:?}");
    }

    #[test]
    fn thresholds_beyond_the_measured_range_are_bounds() {
        assert_eq!(metg(&bare(&[(1e-6, 0.6), (1e-3, 0.9)]), HALF, 0.95), Metg::Below(1e-6));
        assert_eq!(metg(&bare(&[(1e-6, 0.1), (1e-3, 0.4)]), HALF, 0.95), Metg::Above(1e-3));
        assert_eq!(metg(&bare(&[(1e-6, 0.5)]), HALF, 0.95), Metg::Below(1e-6));
    }

    #[test]
    fn of_several_crossings_the_largest_rise_counts() {
        let points = bare(&[(1.0, 0.4), (2.0, 0.6), (4.0, 0.4), (16.0, 0.6), (32.0, 0.45)]);
        let Metg::Value { seconds, between, crossings, .. } = metg(&points, HALF, 0.95) else { panic!() };
        assert!((seconds - 8.0).abs() < 1e-12);
        assert_eq!((between, crossings), ((4.0, 16.0), 4));
    }

    #[test]
    fn resamples_that_do_not_cross_leave_no_interval() {
        let points = vec![(1.0, vec![0.45, 0.45, 0.55]), (2.0, vec![0.9, 0.8, 0.85])];
        let Metg::Value { interval, .. } = metg(&points, HALF, 0.95) else { panic!() };
        assert_eq!(interval, None);
    }

    #[test]
    fn equal_granularities_are_one() {
        let points = bare(&[(1.0, 0.2), (1.0, 0.4), (4.0, 0.7), (1.0, 0.3)]);
        let Metg::Value { seconds, .. } = metg(&points, HALF, 0.95) else { panic!() };
        assert!((seconds - 2.0).abs() < 1e-12);
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        let none = Metg::Undefined(NO_DATA);
        assert_eq!(metg(&[], HALF, 0.95), none);
        assert_eq!(metg(&[(1.0, vec![])], HALF, 0.95), none);
        assert_eq!(metg(&bare(&[(0.0, 0.5), (1.0, 0.6)]), HALF, 0.95), none);
        assert_eq!(metg(&bare(&[(1.0, f64::NAN)]), HALF, 0.95), none);
        assert_eq!(metg(&bare(&[(1.0, 0.6), (2.0, 0.4)]), HALF, 0.95), Metg::Undefined(FALLING));
    }
}
