//! Triangles without area, very small and very large ones, and the two sides of a triangle.

use super::single::{meet, scene, towards, triangle};
use crate::bare_scene::{intersect, searches};
use crate::math::{Ray, Vec3};
use crate::random::Random;
use crate::refusals::refuses_shape;
use crate::scene::{Primitive, Triangle};
use crate::stage::{ANY_CAMERA, DIFFUSE, named, try_scene};
use crate::{Trials, U};
use std::io::Write;

pub(super) fn bad_case(trials: &mut Trials) {
    let bad = triangle([
        [-1_113.454_59, -79.049_614, -56.243_190_8],
        [-1_113.454_59, -87.092_269_9, -56.243_190_8],
        [-1_113.454_59, -79.209_014_9, -56.243_190_8],
    ]);
    let origin = Vec3::new(-1_081.479_25, 99.999_954_2, 87.770_111_1);
    // A direction as long as the segment, and one of length 1, as for the rays of paths.
    let segment = Vec3::new(-32.107_299_8, -183.355_865, -144.607_635);
    trials.same("taken for degenerate", &true, &bad.is_degenerate());
    for direction in [segment, segment.normalized()] {
        let ray = Ray { origin, direction };
        trials.same("primitive", &None, &meet(&bad, &ray));
        for (name, scene) in searches(&scene(vec![bad])) {
            trials.same(format!("accelerator {name}"), &None, &intersect(&scene, &ray, None));
        }
    }
}

pub(super) fn areas(trials: &mut Trials) {
    let (p, q) = ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]);
    let mut random = Random::new(5);
    for corners in [[p, p, p], [p, p, q], [p, q, p], [q, p, p], [[1.0; 3], [2.0; 3], [4.0; 3]]] {
        let line = triangle(corners);
        let mut hits = 0;
        for _ in 0..1000 {
            hits += u64::from(meet(&line, &towards(random.direction() * 10.0, random.direction())).is_some());
        }
        // If all three corners are distinct points of a line, rounding decides at its corners. The reader refuses all
        // of these triangles.
        let twice = (0..3).any(|k| corners[k] == corners[(k + 1) % 3]);
        for at in corners.iter().filter(|_| twice) {
            hits += u64::from(meet(&line, &towards(Vec3::new(-3.0, 4.0, 5.0), Vec3::from(*at))).is_some());
        }
        trials.never(format!("{corners:?}"), "hits", hits, 1000);
        let shape = format!("{{ triangle = {{ corners = {corners:?} }} }}");
        refuses_shape(trials, &shape, "corners", &format!("{corners:?}"));
    }
    for (bad, value) in [("nan", "nan"), ("inf", "inf"), ("-inf", "-inf"), ("1e160", "1e160")] {
        let shape = format!("{{ triangle = {{ corners = [[0.0, 0.0, 0.0], [1.0, {bad}, 1.0], [2.0, 0.0, 2.0]] }} }}");
        refuses_shape(trials, &shape, "corners", value);
    }
    for size in [1e-90, 1e-20, 1.0, 1e15, 1e90] {
        let triangle = triangle([[0.0, 0.0, size], [size, 0.0, size], [0.0, size, size]]);
        let ray = towards(Vec3::new(0.25 * size, 0.25 * size, 0.0), Vec3::new(0.25 * size, 0.25 * size, size));
        let t = meet(&triangle, &ray).unwrap_or(f64::NAN);
        trials.close(format!("{size:e} across"), size, t, 4.0 * U * size);
        trials.same(format!("{size:e} across, normal"), &Vec3::new(0.0, 0.0, 1.0), &triangle.normal(ray.at(size)));
    }
    counted(trials);
}

/// Triangles of a mesh that have no area are left out and counted.
fn counted(trials: &mut Trials) {
    let mut mesh = tempfile::Builder::new().suffix(".obj").tempfile().expect("a temporary file");
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 1 2\nf 2 2 2\n";
    mesh.write_all(text.as_bytes()).expect("a written file");
    let path = mesh.path().to_str().expect("a path in UTF-8");
    let shape = format!("{{ mesh = {{ file = '{path}' }} }}");
    let scene = try_scene(&[ANY_CAMERA.to_string(), named("mesh", &shape, DIFFUSE, 0.0)]);
    let counts = scene.map(|scene| (scene.primitives.triangles.len(), scene.primitives.degenerate));
    trials.same("a mesh of one good triangle and three bad", &Some((1, 3)), &counts.ok());
}

pub(super) fn edge_on(trials: &mut Trials) {
    let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (triangle, winding) in [(triangle([a, b, c]), "counterclockwise"), (triangle([a, c, b]), "clockwise")] {
        let (mut hits, mut tried) = (0, 0);
        for origin in [[-1.0, 0.25, 0.0], [0.25, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.1, 0.1, 0.0]] {
            for target in [[0.25, 0.25, 0.0], [1.0, 0.25, 0.0], [0.25, 1.0, 0.0], [0.0, 0.0, 0.0]] {
                hits += u64::from(meet(&triangle, &towards(Vec3::from(origin), Vec3::from(target))).is_some());
                tried += 1;
            }
        }
        trials.never(winding, "hits", hits, tried);
    }
}

pub(super) fn sides(trials: &mut Trials) {
    for mirrored in [1.0, -1.0] {
        let corners = [[0.0, 0.0, 0.0], [mirrored, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for (name, flat) in searches(&scene(vec![triangle(corners)])) {
            for z in [2.0, -2.0] {
                let ray = towards(Vec3::new(0.25 * mirrored, 0.25, z), Vec3::new(0.25 * mirrored, 0.25, 0.0));
                let hit = intersect(&flat, &ray, None).map(|hit| (hit.t, hit.inside, hit.normal));
                let expected = (2.0, z * mirrored < 0.0, Vec3::new(0.0, 0.0, mirrored));
                trials.same(format!("from z = {z}, x by {mirrored}, accelerator {name}"), &Some(expected), &hit);
            }
        }
    }
    let back = Triangle { corners: [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]].map(Vec3::from) };
    trials.same("clockwise, normal", &Vec3::new(0.0, 0.0, -1.0), &back.normal(back.corners[0]));
}
