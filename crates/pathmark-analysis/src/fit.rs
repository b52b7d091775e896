//! Straight lines through points by ordinary least squares, with t-intervals.
//!
//! The formulas are standard (N. R. Draper and H. Smith, "Applied Regression Analysis", 1998, chapter 1). Centred sums
//! keep their precision for x far from zero. Errors are assumed to be in y, independent and of equal variance.

use super::interval::{Estimate, Interval};
use super::mean::t_quantile;

/// y = intercept + slope x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// y at x = 0, in the unit of y.
    pub intercept: Estimate,
    /// Unit of y per unit of x.
    pub slope: Estimate,
}

/// Least squares line through `points` (x, y); `None` below three points, for equal x, or for a value that is not finite.
pub fn line(points: &[(f64, f64)], level: f64) -> Option<Line> {
    let freedom = points.len().checked_sub(2).filter(|&freedom| freedom > 0)?;
    let sums = Sums::of(points)?;
    let (slope, intercept) = (sums.slope(), sums.intercept());
    let residual: f64 =
        points.iter().map(|&(x, y)| y - (sums.y + slope * (x - sums.x))).map(|error| error * error).sum();
    let variance = residual / freedom as f64;
    let slope_error = (variance / sums.xx).sqrt();
    let intercept_error = (variance * (1.0 / points.len() as f64 + sums.x * sums.x / sums.xx)).sqrt();
    let t = t_quantile(level, freedom)?;
    Some(Line {
        intercept: Estimate { value: intercept, interval: Interval::around(intercept, t * intercept_error, level)? },
        slope: Estimate { value: slope, interval: Interval::around(slope, t * slope_error, level)? },
    })
}

/// The line through (ln x, ln y): its slope is the exponent of a power law. `None` also if a coordinate is not positive.
pub fn log_log(points: &[(f64, f64)], level: f64) -> Option<Line> {
    line(&logarithms(points)?, level)
}

/// (ln x, ln y) of each point; `None` if a coordinate is not positive and finite.
pub(super) fn logarithms(points: &[(f64, f64)]) -> Option<Vec<(f64, f64)>> {
    let positive = |value: f64| value > 0.0 && value.is_finite();
    points.iter().map(|&(x, y)| (positive(x) && positive(y)).then(|| (libm::log(x), libm::log(y)))).collect()
}

/// Means of x and y and the centred sums of squares and products.
pub(super) struct Sums {
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

impl Sums {
    /// `None` for equal x or a sum that is not finite.
    pub(super) fn of(points: &[(f64, f64)]) -> Option<Self> {
        let n = points.len() as f64;
        let x = points.iter().map(|point| point.0).sum::<f64>() / n;
        let y = points.iter().map(|point| point.1).sum::<f64>() / n;
        let sum = |term: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| term(p.0 - x, p.1 - y)).sum::<f64>();
        let (sums, yy) = (Self { x, y, xx: sum(&|dx, _| dx * dx), xy: sum(&|dx, dy| dx * dy) }, sum(&|_, dy| dy * dy));
        // Rounding can leave a positive sum for equal x, so the x are compared directly.
        let spread = points.iter().any(|point| Some(point.0) != points.first().map(|first| first.0)) && sums.xx > 0.0;
        (spread && [sums.xx, sums.xy, yy].iter().all(|sum| sum.is_finite())).then_some(sums)
    }

    pub(super) fn slope(&self) -> f64 {
        self.xy / self.xx
    }

    pub(super) fn intercept(&self) -> f64 {
        self.y - self.slope() * self.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance, "{a} is not {b}");
    }

    #[test]
    fn line_of_anscombes_first_quartet() {
        // F. J. Anscombe, "Graphs in statistical analysis", The American Statistician 27 (1973):
        // y = 3.00 + 0.500 x, standard error of the slope 0.118.
        let xs = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let ys = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68];
        let points: Vec<_> = xs.into_iter().zip(ys).collect();
        let fit = line(&points, 0.95).unwrap();
        close(fit.intercept.value, 3.000_09, 1e-5);
        close(fit.slope.value, 0.500_09, 1e-5);
        // t with 9 degrees of freedom is 2.26216; the standard error of the intercept is 1.125.
        close(fit.slope.interval.high - fit.slope.value, 2.262_16 * 0.117_906, 1e-4);
        close(fit.intercept.interval.high - fit.intercept.value, 2.262_16 * 1.124_75, 1e-4);
    }

    #[test]
    fn exact_lines_are_found_exactly() {
        let fit = line(&[(1e6, 5.0), (1e6 + 1.0, 7.0), (1e6 + 2.0, 9.0)], 0.95).unwrap();
        close(fit.slope.value, 2.0, 1e-12);
        close(fit.slope.interval.high, fit.slope.interval.low, 3e-8);
        let flat = line(&[(1.0, 4.0), (2.0, 4.0), (5.0, 4.0)], 0.95).unwrap();
        assert_eq!((flat.slope.value, flat.intercept.value), (0.0, 4.0));
    }

    #[test]
    fn log_log_finds_the_exponent() {
        let points = [1.0, 4.0, 16.0, 64.0].map(|spp: f64| (spp, 3.0 / spp.sqrt()));
        let fit = log_log(&points, 0.95).unwrap();
        close(fit.slope.value, -0.5, 1e-12);
        close(fit.intercept.value, libm::log(3.0), 1e-12);
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(line(&[], 0.95), None);
        assert_eq!(line(&[(1.0, 2.0), (2.0, 3.0)], 0.95), None);
        assert_eq!(line(&[(0.1, 2.0), (0.1, 3.0), (0.1, 4.0)], 0.95), None);
        assert_eq!(line(&[(1.0, f64::NAN), (2.0, 3.0), (3.0, 4.0)], 0.95), None);
        assert_eq!(line(&[(1e308, 1.0), (-1e308, 2.0), (0.0, 3.0)], 0.95), None);
        assert_eq!(log_log(&[(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)], 0.95), None);
        assert_eq!(log_log(&[(-1.0, 1.0), (2.0, 1.0), (3.0, 1.0)], 0.95), None);
    }
}
