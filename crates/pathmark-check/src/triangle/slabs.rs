//! Ray-box intersection.

use crate::Trials;
use crate::math::{Ray, Vec3};
use crate::scene::Bounds;

/// Whether the ray hits the closed box, in exact arithmetic: coordinates are small multiples of one half, and
/// directions are -1, 0 or 1.
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

/// Directions along axes, faces and diagonals, from points in, on and around boxes. A miss passes at a distance of at
/// least one half, far more than the padding, so every false hit or false miss counts.
pub(super) fn exhaustive(trials: &mut Trials) {
    const STEPS: [f64; 4] = [-1.0, -0.0, 0.0, 1.0];
    const PLACES: [f64; 5] = [-1.0, 0.0, 0.5, 1.0, 2.0];
    let unit = Bounds { low: [0.0; 3], high: [1.0; 3] };
    let mut boxes = vec![unit, Bounds { low: [0.5; 3], high: [0.5; 3] }];
    for axis in 0..3 {
        let mut flat = unit;
        flat.high[axis] = 0.0;
        boxes.push(flat);
    }
    let (mut combinations, mut hits, mut missed, mut invented) = (0, 0, 0, 0);
    let triples = |n: usize| (0..n * n * n).map(move |k| [k % n, k / n % n, k / n / n]);
    for direction in triples(4).map(|k| k.map(|k| STEPS[k])).filter(|d| d.iter().any(|x| *x != 0.0)) {
        for origin in triples(5).map(|k| k.map(|k| PLACES[k])) {
            let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction) };
            for bounds in &boxes {
                let (expected, found) = (meets_exactly(origin, direction, bounds), bounds.meets(&ray));
                combinations += 1;
                hits += u64::from(expected);
                missed += u64::from(expected && !found);
                invented += u64::from(found && !expected);
            }
        }
    }
    trials.same("combinations", &35_000, &combinations);
    trials.never("boxes", "false misses", missed, combinations);
    trials.never("boxes", "false hits", invented, combinations);
    let told = format_args!("{hits} hits");
    trials.holds("the rays", "neither answer is rare", told, hits > 3000 && hits < combinations / 2);
}

/// A box beside the ray, on it, and behind it; and a box of size zero at the origin.
pub(super) fn subnormal(trials: &mut Trials) {
    let tiny = 5.693_442e-39;
    let bounds = Bounds { low: [tiny, -5000.0, 5000.0], high: [tiny, -5000.0, 5000.0] };
    let diagonal = Vec3::new(0.707_106_77, 0.707_106_77, 0.0);
    let meets = |x: f64, y: f64| bounds.meets(&Ray { origin: Vec3::new(x, y, 5000.0), direction: diagonal });
    trials.same("at x = 0 the ray is at y = 0", &false, &meets(-5000.0, -5000.0));
    trials.same("at x = 0 the ray is at y = -5000", &true, &meets(-5000.0, -10_000.0));
    trials.same("the box is behind", &false, &meets(5000.0, 0.0));
    // A point at zero, from there: the padding is zero, and every distance along the other axes is 0 times infinity.
    let (zero, origin) = (Bounds { low: [0.0; 3], high: [0.0; 3] }, Vec3::new(0.0, 0.0, 0.0));
    for direction in [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, -0.0, 1.0]].map(Vec3::from) {
        let meets = zero.meets(&Ray { origin, direction });
        trials.same(format!("a point at zero, from there along {direction:?}"), &true, &meets);
    }
}

/// A ray exactly on the face, or within the padding outside, enters the box. At twice the padding it does not.
pub(super) fn along_a_face(trials: &mut Trials) {
    let bounds = Bounds { low: [0.3, 0.1, 7.0], high: [0.7, 0.9, 9.0] };
    // The padding of a box that reaches to 9, for an origin at 0.5 at least.
    let padding = libm::exp2(-47.0) * 9.5;
    for (outside, expected) in [(0.0, true), (0.99, true), (2.0, false)] {
        let (mut wrong, mut tried) = (0, 0);
        for (axis, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
            let mut origin = [0.5, 0.5, 0.0];
            let face = if sign < 0.0 { bounds.low[axis] } else { bounds.high[axis] };
            origin[axis] = face + sign * outside * padding;
            for (towards, flat) in [(1.0, 0.0), (1.0, -0.0), (-1.0, 0.0), (-1.0, -0.0)] {
                let ray = Ray { origin: Vec3::from(origin), direction: Vec3::new(flat, flat, towards) };
                wrong += u64::from(bounds.meets(&ray) != (expected && towards > 0.0));
                tried += 1;
            }
        }
        let told = if expected { "rays that are not let in" } else { "rays that are let in" };
        trials.never(format!("{outside} paddings outside"), told, wrong, tried);
    }
}
