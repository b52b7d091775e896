//! The exact answer for a line and a sphere: a quadratic in double-double arithmetic. Its discriminant comes from the
//! cross product, |d|² r² - |f x d|², so it shares no formula with the code under test. Exact integers confirm it in
//! `exact_tests.rs`.
//!
//! As in [`crate::math::roots`], `f` is the ray's origin relative to the centre, `d` its direction of any length, `r`
//! the radius.

use crate::U;
use crate::double_double::{Dd, two_product};
use crate::math::{Vec3, dot};

/// The intersection of a line with a sphere.
pub(crate) struct Exact {
    /// Distance of the line from the centre.
    pub(crate) line: f64,
    /// The roots in lengths of `d`, nearer first, rounded once; `None` if the line misses.
    pub(crate) roots: Option<[f64; 2]>,
}

impl Exact {
    pub(crate) fn of(f: Vec3, d: Vec3, r: f64) -> Self {
        let product = |p: Vec3, q: Vec3| two_product(p.x, q.x) + two_product(p.y, q.y) + two_product(p.z, q.z);
        let cross = |a: f64, b: f64, c: f64, e: f64| two_product(a, b) - two_product(c, e);
        let (x, y, z) = (cross(f.y, d.z, f.z, d.y), cross(f.z, d.x, f.x, d.z), cross(f.x, d.y, f.y, d.x));
        let (a, b, moment) = (product(d, d), -product(f, d), x * x + y * y + z * z);
        let discriminant = a * two_product(r, r) - moment;
        let line = (moment.0 / a.0).sqrt();
        if discriminant.0 < 0.0 {
            return Self { line, roots: None };
        }
        let root = discriminant.sqrt();
        let q: Dd = if b.0 > 0.0 { b + root } else { b - root };
        let (by_q, by_c) = (q.over(a), (product(f, f) - two_product(r, r)).over(q));
        Self { line, roots: Some(if by_q < by_c { [by_q, by_c] } else { [by_c, by_q] }) }
    }

    /// Half-width of the band around the radius in which hit and miss may be mistaken for each other: `8u(|f| + r)`.
    pub(crate) fn band(f: Vec3, r: f64) -> f64 {
        8.0 * U * (dot(f, f).sqrt() + r)
    }

    /// The bound `T_s` on the error of root `t`, in lengths of `d`:
    /// `8u(|t| + |f| + (r² + 2l|f|)/2s + (|f|² + r²)/(|b| + s))`. Infinite at tangency, where the slope of the roots
    /// is infinite.
    pub(crate) fn bound(&self, f: Vec3, d: Vec3, r: f64, t: f64) -> f64 {
        let (length, distance, line) = (dot(d, d).sqrt(), dot(f, f).sqrt(), self.line);
        let s = ((r - line) * (r + line)).max(0.0).sqrt();
        let b = dot(f, d).abs() / length;
        let terms = distance + (r * r + 2.0 * line * distance) / (2.0 * s) + (distance * distance + r * r) / (b + s);
        let error = 8.0 * U * (t.abs() + terms / length);
        if error.is_nan() { f64::INFINITY } else { error }
    }
}

/// Whether `found` is the first root ahead. A root within its bound of zero may count as ahead or as behind.
pub(crate) fn is_first(found: Option<f64>, exact: [f64; 2], bounds: [f64; 2]) -> bool {
    let near = |k: usize, t: f64| (t - exact[k]).abs() <= bounds[k];
    let behind = |k: usize| exact[k] <= bounds[k];
    match found {
        None => behind(0) && behind(1),
        Some(t) => near(0, t) || (behind(0) && near(1, t)),
    }
}
