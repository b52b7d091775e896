//! Comparison of two renderers of the same scene: time to equal error, and error after equal time.

use super::interval::Estimate;
use super::price::Renderer;

/// Returns the seconds of `a` to reach an RMSE over the seconds of `b`: below 1 if `a` is better. Both are assumed to
/// be independent, so the interval is wider than necessary if they share samples.
pub fn equal_error(a: &Renderer, b: &Renderer, rmse: f64) -> Option<Estimate> {
    a.price(rmse)?.seconds.times(&b.price(rmse)?.seconds.inverse()?)
}

/// Returns the RMSE of `a` over the RMSE of `b` after the same `seconds`. For independent samples, it is the square
/// root of [`equal_error`].
pub fn equal_time(a: &Renderer, b: &Renderer, seconds: f64) -> Option<Estimate> {
    a.rmse_after(seconds)?.times(&b.rmse_after(seconds)?.inverse()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interval;
    use crate::jackknife::SeedCurves;
    use crate::price::Law;

    fn renderer(variance: f64, per_spp: f64) -> Renderer {
        let curve = |factor: f64| vec![(16.0, factor * variance / 16.0)];
        let interval = Interval { low: 0.99 * per_spp, high: 1.01 * per_spp, level: 0.95 };
        Renderer {
            curves: SeedCurves::of_errors(&[curve(0.98), curve(1.0), curve(1.02), curve(1.0)]).unwrap(),
            law: Law::Independent,
            seconds_per_spp: Estimate { value: per_spp, interval },
        }
    }

    #[test]
    fn six_times_less_variance_for_half_more_time() {
        let (plain, better) = (renderer(6.0, 1.0), renderer(1.0, 1.5));
        let time = equal_error(&better, &plain, 0.01).unwrap();
        let error = equal_time(&better, &plain, 100.0).unwrap();
        assert!((time.value - 0.25).abs() < 1e-4 && time.interval.contains(0.25), "{time:?}");
        assert!((error.value - 0.5).abs() < 1e-4 && error.interval.contains(0.5), "{error:?}");
        assert!((time.interval.high / time.value - 1.0).abs() < 0.05 && !time.interval.contains(0.27));
        let back = equal_error(&plain, &better, 0.01).unwrap();
        assert!((back.value - 4.0).abs() < 1e-3);
    }
}
