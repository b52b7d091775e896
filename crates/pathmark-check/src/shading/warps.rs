//! Warps from the unit square to directions and points: H03, H04, H05.

use super::targets::{cones, triangles};
use crate::analysis::chi_square::against;
use crate::level::critical;
use crate::math::{Vec3, dot};
use crate::sampling::{UNIFORM_SPHERE_DENSITY, concentric_disk, cosine_hemisphere, mix, tent, uniform_sphere, unit};
use crate::{Case, Trials};
use std::f64::consts::{FRAC_1_PI, PI};

pub(super) const CASES: &[Case] = &[
    Case { id: "H03", tries: "the cosine warp at 0, 2^-53, 1/2, 1 - 2^-53 and 1", run: cosine },
    Case { id: "H04", tries: "the tent filter at its ends and its seam", run: tents },
    Case {
        id: "H05",
        tries: "sphere, cone, disk, cosine, tent and triangle: the square's corners, and chi-square",
        run: all,
    },
];

const U: f64 = 0.5 * f64::EPSILON;
const CORNERS: [f64; 5] = [0.0, U, 0.5, 1.0 - U, 1.0];

fn corners() -> impl Iterator<Item = [f64; 2]> {
    CORNERS.into_iter().flat_map(|u| CORNERS.map(|v| [u, v]))
}

/// Distance of a length from 1; NaN counts as infinite.
fn off(square: f64) -> f64 {
    let off = (square.sqrt() - 1.0).abs();
    if off.is_nan() { f64::INFINITY } else { off }
}

/// The length is 1 within 4 roundings, and the direction is never below the horizon, also at 1, which no sampler
/// returns. For values below 1 the density is above zero.
fn cosine(trials: &mut Trials) {
    let worst = corners().map(cosine_hemisphere).map(|d| off(dot(d, d))).fold(0.0, f64::max);
    trials.at_most("length - 1, in roundings", 4.0, worst / U);
    let lowest = corners().map(cosine_hemisphere).map(|d| d.z).fold(f64::INFINITY, f64::min);
    trials.at_least("height at the corners", 0.0, lowest);
    let reachable = corners().filter(|u| u.iter().all(|u| *u < 1.0)).map(|u| cosine_hemisphere(u).z * FRAC_1_PI);
    trials.at_least("density below 1", 1e-9, reachable.fold(f64::INFINITY, f64::min));
}

/// The argument of sqrt(2 - r) is never negative, and the tent is symmetric: its variance is 1/6.
fn tents(trials: &mut Trials) {
    for (u, expected) in [(0.0, -1.0), (0.125, -0.5), (0.5, 0.0), (0.875, 0.5), (1.0, 1.0)] {
        trials.close(format!("at {u}"), expected, tent(u), 0.0);
    }
    for u in [U, 0.5 - U, 0.5 + 2.0 * U, 1.0 - U] {
        let found = tent(u);
        trials.holds(format!("at {u:?}"), "-1 to 1", found, (-1.0..=1.0).contains(&found));
        trials.close(format!("at {u:?}, mirrored"), -found, tent(1.0 - u), 1e-15);
    }
    let n = trials.times(100_000, 10_000_000);
    let squares = (0..n).map(|k| tent((k as f64 + 0.5) / n as f64)).map(|x| x * x).sum::<f64>();
    trials.close("variance", 1.0 / 6.0, squares / n as f64, 1e-6);
}

/// A warp with its cells of equal probability: `place` gives two coordinates from 0 to 1, which should be uniform over
/// the unit square.
struct Warp {
    name: &'static str,
    place: fn([f64; 2]) -> [f64; 2],
}

fn turns(x: f64, y: f64) -> f64 {
    (libm::atan2(y, x) / (2.0 * PI)).rem_euclid(1.0)
}

/// The integral of the tent's density 1 - |x| from -1.
fn below(x: f64) -> f64 {
    let rest = 1.0 - x.abs();
    if x < 0.0 { 0.5 * rest * rest } else { 1.0 - 0.5 * rest * rest }
}

/// Heights on a sphere are uniform (Archimedes). So are squared radii on a disk and on the disk under a cosine
/// hemisphere.
const WARPS: [Warp; 4] = [
    Warp {
        name: "uniform sphere",
        place: |u| {
            let d = uniform_sphere(u);
            [0.5 + 0.5 * d.z, turns(d.x, d.y)]
        },
    },
    Warp {
        name: "concentric disk",
        place: |u| {
            let [x, y] = concentric_disk(u);
            [x * x + y * y, turns(x, y)]
        },
    },
    Warp {
        name: "cosine hemisphere",
        place: |u| {
            let d = cosine_hemisphere(u);
            [d.x * d.x + d.y * d.y, turns(d.x, d.y)]
        },
    },
    Warp { name: "tent", place: |[u, v]| [below(tent(u)), below(tent(v))] },
];

const CELLS: usize = 64;

/// Tests the corners, moments that a missing root would change, and chi-square on 64 x 64 cells of equal probability.
fn all(trials: &mut Trials) {
    let sphere = |u: [f64; 2]| off(dot(uniform_sphere(u), uniform_sphere(u)));
    trials.at_most("sphere: length - 1, in roundings", 8.0, corners().map(sphere).fold(0.0, f64::max) / U);
    let disk = |u: [f64; 2]| concentric_disk(u).iter().map(|x| x * x).sum::<f64>();
    let outermost = corners().map(disk).fold(0.0, |worst, this| if this <= worst { worst } else { this });
    trials.at_most("disk: square of the radius", 1.0 + 8.0 * U, outermost);
    trials.same("disk: its middle", &[0.0, 0.0], &concentric_disk([0.5, 0.5]));
    trials.close("sphere: density times area", 1.0, UNIFORM_SPHERE_DENSITY * 4.0 * PI, 2.0 * U);
    moments(trials);
    cones(trials);
    triangles(trials);
    let samples = trials.times(400_000, 20_000_000);
    let limit = critical(2 * WARPS.len());
    for (number, warp) in (0..).zip(&WARPS) {
        let mut cells = vec![0.0; CELLS * CELLS];
        for k in 0..samples {
            let key = mix(number << 48 | k);
            let place = (warp.place)([unit(key), unit(mix(key))]);
            let [row, column] = place.map(|x| ((x * CELLS as f64) as usize).min(CELLS - 1));
            cells[row * CELLS + column] += 1.0;
        }
        let even = vec![samples as f64 / cells.len() as f64; cells.len()];
        trials.deviates_below(format!("{}: chi-square", warp.name), limit, against(&cells, &even));
    }
}

/// Means over the midpoints of a grid: on the sphere 1/3 for z² and 1/5 for z⁴, on the disk 1/3 for r⁴ and 1/24 for x²
/// y².
fn moments(trials: &mut Trials) {
    let n = 512;
    let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
    let mean =
        |of: &dyn Fn([f64; 2]) -> f64| (0..n * n).map(|k| of([at(k % n), at(k / n)])).sum::<f64>() / f64::from(n * n);
    let on_sphere = |of: fn(Vec3) -> f64| mean(&|u| of(uniform_sphere(u)));
    let on_disk = |of: fn([f64; 2]) -> f64| mean(&|u| of(concentric_disk(u)));
    for (name, expected, found) in [
        ("sphere: mean of z²", 1.0 / 3.0, on_sphere(|d| d.z * d.z)),
        ("sphere: mean of x²", 1.0 / 3.0, on_sphere(|d| d.x * d.x)),
        ("sphere: mean of z⁴", 0.2, on_sphere(|d| d.z * d.z * d.z * d.z)),
        ("sphere: mean of xy", 0.0, on_sphere(|d| d.x * d.y)),
        ("disk: mean of r⁴", 1.0 / 3.0, on_disk(|[x, y]| (x * x + y * y) * (x * x + y * y))),
        ("disk: mean of x² y²", 1.0 / 24.0, on_disk(|[x, y]| x * x * y * y)),
        ("disk: mean of xy", 0.0, on_disk(|[x, y]| x * y)),
    ] {
        trials.close(name, expected, found, 1e-5);
    }
}
