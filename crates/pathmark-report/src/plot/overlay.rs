//! Overlays: lines given by formulas, ideal or fitted.

use super::axis::Range;

/// y as a function of x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Curve {
    /// y = intercept + slope x.
    Line { intercept: f64, slope: f64 },
    /// y = scale x^exponent: straight on two logarithmic axes.
    Power { scale: f64, exponent: f64 },
    /// y = x / (1 + `serial_share` (x - 1)): speedup over workers by Amdahl's law.
    Amdahl { serial_share: f64 },
}

impl Curve {
    /// The power law with this exponent through a point; `None` if there is none, as for x = 0.
    pub fn power_through((x, y): (f64, f64), exponent: f64) -> Option<Self> {
        let scale = y / libm::pow(x, exponent);
        (x > 0.0 && scale.is_finite()).then_some(Self::Power { scale, exponent })
    }

    /// y at `x`.
    pub fn at(&self, x: f64) -> f64 {
        match *self {
            Self::Line { intercept, slope } => intercept + slope * x,
            Self::Power { scale, exponent } => scale * libm::pow(x, exponent),
            Self::Amdahl { serial_share } => x / (1.0 + serial_share * (x - 1.0)),
        }
    }
}

/// A curve over the points, with its entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// Its text in the legend; may have several lines.
    pub label: String,
    pub curve: Curve,
    /// The number of the series that it is fitted to, whose colour it has; `None` for a theoretical line, which is grey.
    pub fitted_to: Option<usize>,
}

impl Overlay {
    pub fn guide(label: impl Into<String>, curve: Curve) -> Self {
        Self { label: label.into(), curve, fitted_to: None }
    }

    /// A line fitted to series number `series`.
    pub fn fit(label: impl Into<String>, curve: Curve, series: usize) -> Self {
        Self { label: label.into(), curve, fitted_to: Some(series) }
    }
}

/// The parts of a curve inside the ranges, as shares of the axes (0 to 1 each way, y up).
pub(super) fn inside(curve: &Curve, x: &Range, y: &Range) -> Vec<Vec<(f64, f64)>> {
    const STEPS: u32 = 128;
    let places = (0..=STEPS).map(|i| {
        let at = f64::from(i) / f64::from(STEPS);
        y.place(curve.at(x.value(at))).map(|height| (at, height))
    });
    let mut parts: Vec<Vec<(f64, f64)>> = vec![Vec::new()];
    let mut before: Option<(f64, f64)> = None;
    for place in places {
        let piece = before.zip(place).and_then(|(a, b)| clip(a, b));
        if let (Some((a, b)), Some(part)) = (piece, parts.last_mut()) {
            // The shared end is now cut from the other side, so it can differ in its last bit.
            if part.last().is_some_and(|end| (end.0 - a.0).abs() + (end.1 - a.1).abs() < 1e-12) {
                part.push(b);
            } else {
                parts.push(vec![a, b]);
            }
        }
        before = place;
    }
    parts.retain(|part| part.len() > 1);
    parts.iter().map(|part| corners(part)).collect()
}

/// Leaves out points on the straight line between their neighbours: rounded to pixels, they would make the line wobble.
fn corners(places: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    for (i, &here) in places.iter().enumerate() {
        let straight = kept.last().zip(places.get(i + 1)).is_some_and(|(&before, &next)| {
            let cross = (here.0 - before.0) * (next.1 - before.1) - (here.1 - before.1) * (next.0 - before.0);
            cross.abs() < 1e-9
        });
        if !straight {
            kept.push(here);
        }
    }
    kept
}

/// The part of a straight segment with heights from 0 to 1; `None` if there is none.
fn clip(a: (f64, f64), b: (f64, f64)) -> Option<((f64, f64), (f64, f64))> {
    if a.1.max(b.1) < 0.0 || a.1.min(b.1) > 1.0 {
        return None;
    }
    let cut = |from: (f64, f64), to: (f64, f64)| {
        let height = from.1.clamp(0.0, 1.0);
        let share = if (height - from.1).abs() > 0.0 { (height - from.1) / (to.1 - from.1) } else { 0.0 };
        (from.0 + share * (to.0 - from.0), height)
    };
    Some((cut(a, b), cut(b, a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::axis::Axis;

    fn ranges() -> (Range, Range) {
        let axis = |high: f64| Range::of(&Axis::linear("v"), [0.0, high]).unwrap();
        (axis(8.0), axis(4.0))
    }

    #[test]
    fn curves_go_through_their_point() {
        let half = Curve::power_through((16.0, 0.25), -0.5).unwrap();
        assert!((half.at(64.0) - 0.125).abs() < 1e-12);
        assert!((Curve::Line { intercept: 1.0, slope: 2.0 }.at(3.0) - 7.0).abs() < 1e-12);
        // 1 / (0.25 + 0.75 / 3) = 2.
        assert!((Curve::Amdahl { serial_share: 0.25 }.at(3.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn ideal_line_is_cut_at_the_frame() {
        let (x, y) = ranges();
        let parts = inside(&Curve::Line { intercept: 0.0, slope: 1.0 }, &x, &y);
        assert_eq!((parts.len(), parts[0].len()), (1, 2));
        let (first, last) = (parts[0][0], parts[0][parts[0].len() - 1]);
        assert_eq!(first, (0.0, 0.0));
        assert!((last.0 - 0.5).abs() < 1e-9 && (last.1 - 1.0).abs() < 1e-12, "{last:?}");
    }

    #[test]
    fn curves_elsewhere_or_without_value_leave_nothing() {
        let (x, y) = ranges();
        assert!(inside(&Curve::Line { intercept: 9.0, slope: 0.0 }, &x, &y).is_empty());
        assert!(inside(&Curve::Line { intercept: f64::NAN, slope: 0.0 }, &x, &y).is_empty());
        assert!(inside(&Curve::Power { scale: 1e300, exponent: 9.0 }, &x, &y).len() <= 1);
        assert_eq!(Curve::power_through((0.0, 1.0), -0.5), None);
    }
}
