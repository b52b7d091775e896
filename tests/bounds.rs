//! Ray against box: T10-T12 of the catalogue of hard cases.

use pathmark::math::{Ray, Vec3};
use pathmark::scene::Bounds;

/// Whether the ray meets the closed box, in exact arithmetic: everything is a small multiple of one half, and directions are -1, 0 or 1.
fn meets_exactly(origin: [f64; 3], direction: [f64; 3], bounds: &Bounds) -> bool {
    let halves = |x: f64| (2.0 * x) as i32;
    let (mut enter, mut leave) = (0, i32::MAX);
    for axis in 0..3 {
        let (low, high) = (halves(bounds.low[axis]), halves(bounds.high[axis]));
        let start = halves(origin[axis]);
        match halves(direction[axis]) / 2 {
            0 if start < low || start > high => return false,
            0 => {}
            step => {
                let (a, b) = ((low - start) * step, (high - start) * step);
                (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
            }
        }
    }
    enter <= leave
}

/// T10: every combination of directions along axes, faces and diagonals, with both zeros, from points in, on and around boxes that may be
/// flat. Nothing that misses passes closer than one half, far beyond the padding, so no wrong answer is excused in either direction.
#[test]
fn all_35000_combinations_are_exact() {
    const STEPS: [f64; 4] = [-1.0, -0.0, 0.0, 1.0];
    const PLACES: [f64; 5] = [-1.0, 0.0, 0.5, 1.0, 2.0];
    let unit = Bounds { low: [0.0; 3], high: [1.0; 3] };
    let mut boxes = vec![unit, Bounds { low: [0.5; 3], high: [0.5; 3] }];
    for axis in 0..3 {
        let mut flat = unit;
        flat.high[axis] = 0.0;
        boxes.push(flat);
    }
    let (mut combinations, mut hits) = (0, 0);
    let triples = |n: usize| (0..n * n * n).map(move |k| [k % n, k / n % n, k / n / n]);
    for direction in triples(4).map(|k| k.map(|k| STEPS[k])).filter(|d| d.iter().any(|x| *x != 0.0)) {
        for origin in triples(5).map(|k| k.map(|k| PLACES[k])) {
            let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction) };
            for bounds in &boxes {
                let expected = meets_exactly(origin, direction, bounds);
                assert_eq!(bounds.meets(&ray), expected, "{ray:?} against {bounds:?}");
                combinations += 1;
                hits += i32::from(expected);
            }
        }
    }
    assert_eq!(combinations, 35_000);
    assert!(hits > 3000 && hits < 17_000, "{hits} hits: one of the answers is rare");
}

/// T11: a flat box of subnormal size beside the ray's way, and on it.
#[test]
fn a_subnormal_flat_box() {
    let tiny = 5.693_442e-39;
    let bounds = Bounds { low: [tiny, -5000.0, 5000.0], high: [tiny, -5000.0, 5000.0] };
    let diagonal = Vec3::new(0.707_106_77, 0.707_106_77, 0.0);
    let from = |x: f64, y: f64| Ray { origin: Vec3::new(x, y, 5000.0), direction: diagonal };
    assert!(!bounds.meets(&from(-5000.0, -5000.0)), "where the ray passes x = 0 it is at y = 0");
    assert!(bounds.meets(&from(-5000.0, -10_000.0)), "this one comes by");
    assert!(!bounds.meets(&from(5000.0, 0.0)), "the box is behind");
}

/// T12: along a face, exactly on it and as far outside as the padding reaches; at twice that the ray is outside.
#[test]
fn along_a_face() {
    let bounds = Bounds { low: [0.3, 0.1, 7.0], high: [0.7, 0.9, 9.0] };
    // Of a box that reaches to 9 and an origin at 0.5 at least.
    let padding = libm::exp2(-47.0) * 9.5;
    for (axis, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
        for (outside, expected) in [(0.0, true), (0.99, true), (2.0, false)] {
            let mut origin = [0.5, 0.5, 0.0];
            let face = if sign < 0.0 { bounds.low[axis] } else { bounds.high[axis] };
            origin[axis] = face + sign * outside * padding;
            for towards in [1.0, -1.0] {
                let direction = Vec3::new(0.0, 0.0, towards);
                let ray = Ray { origin: Vec3::from(origin), direction };
                assert_eq!(bounds.meets(&ray), expected && towards > 0.0, "axis {axis}, {outside} paddings outside");
            }
        }
    }
}
