//! Warps from the unit square to directions and points, and aims at lights, mapped to cells of equal probability: H03,
//! H04, H05.

use super::unguarded::crowded_triangle;
use crate::analysis::chi_square::against;
use crate::math::{Frame, Vec3, dot};
use crate::sampling::{UNIFORM_SPHERE_DENSITY, concentric_disk, cosine_hemisphere, mix, tent, uniform_sphere, unit};
use crate::scene::{Scene, one_minus_cos};
use crate::stage::{camera_above, diffuse, object, scene, sphere};
use crate::{Trials, U, critical};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

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
pub(super) fn cosine(trials: &mut Trials) {
    let worst = corners().map(cosine_hemisphere).map(|d| off(dot(d, d))).fold(0.0, f64::max);
    trials.at_most("length - 1, in roundings", 4.0, worst / U);
    let lowest = corners().map(cosine_hemisphere).map(|d| d.z).fold(f64::INFINITY, f64::min);
    trials.at_least("height at the corners", 0.0, lowest);
    let reachable = corners().filter(|u| u.iter().all(|u| *u < 1.0)).map(|u| cosine_hemisphere(u).z * FRAC_1_PI);
    trials.at_least("density below 1", 1e-9, reachable.fold(f64::INFINITY, f64::min));
}

/// The argument of sqrt(2 - r) is never negative, and the tent is symmetric: its variance is 1/6.
pub(super) fn tents(trials: &mut Trials) {
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
pub(super) fn all(trials: &mut Trials) {
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

const AIM_CELLS: usize = 32;

/// A scene with a single light to aim at.
pub(super) fn lit(shape: &str) -> Scene {
    let scene = scene(&[
        "background = [0.0, 0.0, 0.0]\n".to_string(),
        camera_above([0.0, 0.0, 4.0], [0.0; 3], 40.0),
        object(shape, &diffuse(0.0), [1.0; 3]),
    ]);
    scene.lit(&scene.camera.view(8, 8))
}

/// Chi-square score of positions, with two coordinates from 0 to 1, against a uniform distribution over the square.
fn score(samples: u64, place: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let mut cells = vec![0.0; AIM_CELLS * AIM_CELLS];
    for k in 0..samples {
        let [row, column] = place([unit(mix(2 * k)), unit(mix(2 * k + 1))])
            .map(|x| ((x * AIM_CELLS as f64) as usize).min(AIM_CELLS - 1));
        cells[row * AIM_CELLS + column] += 1.0;
    }
    against(&cells, &vec![samples as f64 / cells.len() as f64; cells.len()])
}

/// Within the cone that a sphere subtends, heights are uniform, as on the whole sphere.
fn cones(trials: &mut Trials) {
    let scene = lit(&sphere([0.0; 3], 1.0));
    let samples = trials.times(200_000, 20_000_000);
    let limit = critical(4);
    for distance in [1.001, 2.0, 100.0, 1e6] {
        let axis = Vec3::new(0.36, 0.48, 0.8);
        let frame = Frame::around(-axis);
        let lights = scene.lights.as_ref().expect("a lit scene");
        let place = |u: [f64; 2]| {
            let aim = lights.aim(axis * distance, None, || 0.5, u);
            let d = aim.map_or(Vec3::new(0.0, 0.0, -1.0), |aim| frame.to_local(aim.direction));
            // 1 - z without cancellation.
            let height = (d.x * d.x + d.y * d.y) / (1.0 + d.z) / one_minus_cos(1.0, distance);
            [height, (libm::atan2(d.y, d.x) / TAU).rem_euclid(1.0)]
        };
        trials.deviates_below(
            format!("cone of a sphere {distance} radii away: chi-square"),
            limit,
            score(samples, place),
        );
    }
}

/// Over the area of a triangle, the squared distance from a corner and the direction are uniform. Without the square
/// root, points crowd at that corner.
fn triangles(trials: &mut Trials) {
    let corners = [[0.2, -0.3, 0.1], [1.5, 0.4, -0.2], [-0.1, 1.1, 0.6]];
    let scene = lit(&format!("{{ triangle = {{ corners = {corners:?} }} }}"));
    let lights = scene.lights.as_ref().expect("a lit scene");
    let [a, b, c] = corners.map(Vec3::from);
    let (point, normal) = (Vec3::new(0.3, 0.2, 3.0), (b - a).cross(c - a));
    let place = |u: [f64; 2]| {
        let direction = lights.aim(point, None, || 0.5, u).map_or(normal, |aim| aim.direction);
        let at = point + direction * (dot(a - point, normal) / dot(direction, normal)) - a;
        // The barycentric coordinates of the two other corners.
        let [p, q] = [at.cross(c - a), (b - a).cross(at)].map(|part| dot(part, normal) / dot(normal, normal));
        [(p + q) * (p + q), q / (p + q)]
    };
    let samples = trials.times(200_000, 20_000_000);
    trials.deviates_below("triangle: chi-square", critical(1), score(samples, place));
    let crowded = score(samples, |u| {
        let [p, q] = crowded_triangle(u);
        [(p + q) * (p + q), q / (p + q)]
    });
    trials.at_least("triangle without the root: chi-square", 20.0, crowded);
}
