//! Rays through edges and corners that triangles share.

use super::single::moller_trumbore;
use super::single::{meet, scene, towards, triangle};
use crate::Trials;
use crate::bare_scene::{intersect, searches};
use crate::math::{Ray, Vec3, dot};
use crate::meshes::{grid_cube, icosphere, star};
use crate::random::Random;
use crate::scene::{Primitive, Triangle};

pub(super) fn diagonal(trials: &mut Trials) {
    let [a, b, c, d] = [[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [5.0, 5.0, 0.0], [-5.0, 5.0, 0.0]];
    let single = |x: f64| f64::from(x as f32);
    let direction = Vec3::new(single(0.304_584_47), single(0.304_584_47), single(-0.902_472_5));
    let ray = Ray { origin: Vec3::new(0.0, 0.0, 10.0), direction };
    for (halves, order) in [([[a, b, c], [a, c, d]], "lower half first"), ([[a, c, d], [a, b, c]], "upper half first")]
    {
        let quad = scene(halves.map(triangle).to_vec());
        let both = quad.primitives.triangles.iter().filter(|half| meet(half, &ray).is_some()).count();
        trials.same(format!("{order}, halves that are hit"), &2, &both);
        for (name, quad) in searches(&quad) {
            let hit = intersect(&quad, &ray, None);
            let off = hit.map_or(f64::NAN, |hit| {
                let off = hit.point - Vec3::new(3.375, 3.375, 0.0);
                dot(off, off).sqrt()
            });
            trials.close(format!("{order}, accelerator {name}, off (3.375, 3.375, 0)"), 0.0, off, 1e-6);
            trials.same(format!("{order}, accelerator {name}, number"), &Some(0), &hit.map(|hit| hit.primitive));
        }
    }
}

/// Meshes by name, with the largest distance of ray origins from the centre.
fn meshes() -> [(&'static str, Vec<Triangle>, f64); 4] {
    let scaled = |mesh: Vec<Triangle>, factor: f64| mesh.iter().map(|triangle| triangle.scaled(factor)).collect();
    let mut random = Random::new(0x51A2);
    [
        ("spikes, 16 x 16", star(16, 16, || 0.5 + random.unit()), 0.1),
        ("icosphere of 1280", icosphere(3), 0.45),
        ("globe of radius 1000", scaled(star(10, 20, || 1.0), 1000.0), 450.0),
        ("globe of radius 1e-6", scaled(star(5, 7, || 1.0), 1e-6), 1e-15),
    ]
}

pub(super) fn closed_meshes(trials: &mut Trials) {
    let all = trials.times(200_000, 1_000_000_000);
    // Testing every triangle takes time in proportion to their number.
    let (every, mut leaks, mut compared) = (256, 0, 0);
    for (mesh, triangles, away) in meshes() {
        let plain = scene(triangles.clone());
        for (name, scene) in searches(&plain) {
            let rays = all / 8 / if scene.hierarchy.is_none() { every } else { 1 };
            let mut random = Random::new(0x51A3);
            let mut missed = 0;
            for _ in 0..rays {
                let [a, b, _] = triangles[random.below(triangles.len())].corners;
                let target = if random.below(4) == 0 { a } else { a + (b - a) * random.unit() };
                let ray = towards(random.direction() * (away * random.unit()), target);
                missed += u64::from(intersect(&scene, &ray, None).is_none());
                if scene.hierarchy.is_none() {
                    let is_hit = |triangle: &Triangle| moller_trumbore(triangle.corners, &ray) > 0.0;
                    leaks += u64::from(!triangles.iter().any(is_hit));
                    compared += 1;
                }
            }
            trials.never(format!("{mesh}, accelerator {name}"), "rays that pass between", missed, rays);
        }
    }
    let told = format_args!("{leaks} of {compared} pass between");
    trials.holds("Möller and Trumbore's test", "some, or these rays would prove nothing", told, leaks > 0);
}

pub(super) fn integer_corners(trials: &mut Trials) {
    const N: i32 = 8;
    for (name, cube) in searches(&scene(grid_cube(N))) {
        let (mut wrong, mut tried) = (0, 0);
        for (x, y, z) in (1..2 * N).flat_map(|x| (1..2 * N).flat_map(move |y| [3, 8].map(move |z| (x, y, z)))) {
            let origin = [x, y, z].map(|halves| f64::from(halves) / 2.0);
            for (axis, sign) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, -1.0), (2, 1.0)] {
                let mut direction = [0.0 * sign; 3];
                direction[axis] = sign;
                let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction) };
                let way = if sign < 0.0 { origin[axis] } else { f64::from(N) - origin[axis] };
                wrong += u64::from(intersect(&cube, &ray, None).map(|hit| hit.t) != Some(way));
                tried += 1;
            }
        }
        trials.never(
            format!("accelerator {name}"),
            "ways that are not the integer or half that they are",
            wrong,
            tried,
        );
    }
}
