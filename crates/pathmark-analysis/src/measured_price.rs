//! The measured price of an accuracy: the seconds at which a curve of error against time crosses a goal. It is
//! interpolated between two neighbouring points that were measured, and never extrapolated.
//!
//! The units of the error are seeds, those of the time processes. So the interval joins two parts: the jackknife over seeds
//! moves the place between the two points, and the intervals of their times move the points themselves.

use super::interval::{Estimate, Interval};
use super::jackknife::{Curve, SeedCurves};

/// Seconds at a number of samples, with their interval if there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timed {
    pub spp: f64,
    pub seconds: f64,
    pub interval: Option<Interval>,
}

/// The place of a goal on a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeasuredPrice {
    /// Between two neighbouring points.
    Between(Crossing),
    /// The error is smaller even at the first point.
    BeforeFirst(Timed),
    /// The error is larger even at the last point.
    BeyondLast(Timed),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Samples per pixel of the neighbours.
    pub between: [f64; 2],
    pub seconds: f64,
    /// `None` for one seed, or if a neighbour's time has no interval.
    pub interval: Option<Interval>,
}

impl MeasuredPrice {
    /// The seconds at which the seeds' mean error first falls to `rmse`. `None` without a point that has a time, or for a
    /// curve with an error that has no logarithm.
    pub fn of(seeds: &[Curve], times: &[Timed], rmse: f64) -> Option<Self> {
        let goal = Some(rmse * rmse).filter(|goal| *goal > 0.0)?;
        let curves = SeedCurves::of_errors(seeds);
        let whole = curves.as_ref().map_or_else(|| seeds.first(), |curves| Some(curves.whole()))?;
        let timed = |(spp, mse): &(f64, f64)| Some((*times.iter().find(|timed| timed.spp == *spp)?, *mse));
        let points: Vec<(Timed, f64)> = whole.iter().filter_map(timed).collect();
        if points.iter().any(|(timed, mse)| *mse <= 0.0 || timed.seconds <= 0.0) {
            return None;
        }
        let (first, last) = (points.first()?, points.last()?);
        if first.1 <= goal {
            return Some(if first.1 < goal {
                Self::BeforeFirst(first.0)
            } else {
                Self::Between(Crossing::at(first.0))
            });
        }
        let Some(pair) = points.windows(2).find(|pair| pair[1].1 <= goal) else {
            return Some(Self::BeyondLast(last.0));
        };
        let neighbours = [pair[0].0, pair[1].0];
        let share = |curve: &Curve| share(curve, neighbours, goal);
        let seconds = |share: f64| between(neighbours.map(|point| point.seconds), share);
        let plain = share(whole)?;
        let by_seeds = curves.as_ref().and_then(|curves| {
            let level = neighbours[0].interval?.level;
            curves.positive_estimate(level, |curve| Some(seconds(share(curve)?)))
        });
        let found = by_seeds.and_then(|found| found.times(&relative(neighbours, plain)?));
        Some(Self::Between(Crossing {
            between: neighbours.map(|point| point.spp),
            seconds: found.map_or(seconds(plain), |found| found.value),
            interval: found.map(|found| found.interval),
        }))
    }
}

impl Crossing {
    fn at(point: Timed) -> Self {
        Self { between: [point.spp; 2], seconds: point.seconds, interval: None }
    }
}

/// The place of a goal on the straight line through two points of a curve, on logarithmic axes: 0 is the first, 1 the
/// second.
fn share(curve: &Curve, neighbours: [Timed; 2], goal: f64) -> Option<f64> {
    let [above, below] = neighbours.map(|point| curve.iter().find(|(spp, _)| *spp == point.spp).map(|point| point.1));
    let (above, below) = (libm::log(above?), libm::log(below?));
    Some((above - libm::log(goal)) / (above - below)).filter(|share| share.is_finite())
}

fn between([first, second]: [f64; 2], share: f64) -> f64 {
    libm::exp((1.0 - share) * libm::log(first) + share * libm::log(second))
}

/// The interval of the time between two points, relative to the time.
fn relative(neighbours: [Timed; 2], share: f64) -> Option<Estimate> {
    let [first, second] = neighbours.map(|point| {
        let Interval { low, high, level } = point.interval.filter(|interval| interval.low > 0.0)?;
        Some((low / point.seconds, high / point.seconds, level))
    });
    let ((low, high, level), (other_low, other_high, _)) = (first?, second?);
    let interval = Interval::between(between([low, other_low], share), between([high, other_high], share), level)?;
    Some(Estimate { value: 1.0, interval })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPP: [f64; 4] = [8.0, 16.0, 32.0, 64.0];

    /// MSE = v/n.
    fn curve(variance: f64) -> Curve {
        SPP.map(|spp| (spp, variance / spp)).to_vec()
    }

    /// t = .02 n, ± 1 %.
    fn times() -> Vec<Timed> {
        let interval = |seconds: f64| Interval { low: 0.99 * seconds, high: 1.01 * seconds, level: 0.95 };
        SPP.map(|spp| Timed { spp, seconds: 0.02 * spp, interval: Some(interval(0.02 * spp)) }).to_vec()
    }

    /// MSE = 4/n and t = .02 n: an RMSE of e takes .08/e² seconds.
    #[test]
    fn a_price_between_points_is_the_closed_form() {
        let seeds = [curve(3.9), curve(4.0), curve(4.1)];
        for rmse in [0.26, 0.3, 0.5, 0.7] {
            let Some(MeasuredPrice::Between(found)) = MeasuredPrice::of(&seeds, &times(), rmse) else {
                panic!("{rmse}")
            };
            let exact = 0.08 / (rmse * rmse);
            assert!((found.seconds / exact - 1.0).abs() < 2e-4, "{rmse}: {found:?}, {exact}");
            let spp = exact / 0.02;
            assert!(found.between[0] <= spp && spp <= found.between[1], "{rmse}: {found:?}");
            // Standard error of the mean of the three variances: 1.44 %, t with two degrees of freedom 4.303; 1 % of the
            // time.
            let width = libm::hypot(4.303 * 0.014_43, 0.01);
            let half = libm::log(found.interval.unwrap().high / found.seconds);
            assert!((half / width - 1.0).abs() < 0.05, "{rmse}: {half} {width}");
        }
    }

    #[test]
    fn a_goal_outside_of_the_points_is_not_measured() {
        let seeds = [curve(3.9), curve(4.1)];
        assert_eq!(MeasuredPrice::of(&seeds, &times(), 0.71), Some(MeasuredPrice::BeforeFirst(times()[0])));
        assert_eq!(MeasuredPrice::of(&seeds, &times(), 0.249), Some(MeasuredPrice::BeyondLast(times()[3])));
    }

    /// One seed has a price without an interval; without times or errors there is none.
    #[test]
    fn degenerate_input_has_no_interval_or_no_answer() {
        let Some(MeasuredPrice::Between(found)) = MeasuredPrice::of(&[curve(4.0)], &times(), 0.5) else { panic!() };
        assert!((found.seconds - 0.32).abs() < 1e-12 && found.interval.is_none(), "{found:?}");
        assert_eq!(MeasuredPrice::of(&[curve(4.0)], &[], 0.5), None);
        assert_eq!(MeasuredPrice::of(&[], &times(), 0.5), None);
        assert_eq!(MeasuredPrice::of(&[curve(-4.0)], &times(), 0.5), None);
        assert_eq!(MeasuredPrice::of(&[curve(4.0)], &times(), 0.0), None);
    }
}
