//! Aims at lights, mapped to cells of equal probability.

use super::unguarded::crowded_triangle;
use crate::Trials;
use crate::analysis::chi_square::against;
use crate::level::critical;
use crate::math::{Frame, Vec3, dot};
use crate::sampling::{mix, unit};
use crate::scene::{Scene, one_minus_cos};
use crate::stage::{camera_above, diffuse, object, scene, sphere};
use std::f64::consts::TAU;

const CELLS: usize = 32;

/// A scene with a single light to aim at.
fn lit(shape: &str) -> Scene {
    let scene = scene(&[
        "background = [0.0, 0.0, 0.0]\n".to_string(),
        camera_above([0.0, 0.0, 4.0], [0.0; 3], 40.0),
        object(shape, &diffuse(0.0), [1.0; 3]),
    ]);
    scene.lit(&scene.camera.view(8, 8))
}

/// Chi-square score of positions, with two coordinates from 0 to 1, against a uniform distribution over the square.
fn score(samples: u64, place: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let mut cells = vec![0.0; CELLS * CELLS];
    for k in 0..samples {
        let [row, column] =
            place([unit(mix(2 * k)), unit(mix(2 * k + 1))]).map(|x| ((x * CELLS as f64) as usize).min(CELLS - 1));
        cells[row * CELLS + column] += 1.0;
    }
    against(&cells, &vec![samples as f64 / cells.len() as f64; cells.len()])
}

/// Within the cone that a sphere subtends, heights are uniform, as on the whole sphere.
pub(super) fn cones(trials: &mut Trials) {
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
pub(super) fn triangles(trials: &mut Trials) {
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
