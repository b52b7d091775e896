//! Distances shorter than any usual epsilon: inside tiny balls, and along the surfaces of large ones.

use super::formulas::{SMALLPT_EPSILON, smallpt_first_root};
use crate::bare_scene::{intersect, searches};
use crate::material::Material;
use crate::math::{Frame, Ray, Vec3};
use crate::random::Random;
use crate::scene::{AllEffects, Hit, Scene, SurfaceOrigin};
use crate::stage::{ANY_CAMERA, DIFFUSE, GLASS, ball, try_scene};
use crate::{Trials, U};
use std::f64::consts::TAU;

/// A glass ball in the centre of a dark one.
fn glass(center: [f64; 3], radius: f64, around: f64) -> Scene {
    let parts = [ANY_CAMERA.into(), ball("glass", center, radius, GLASS), ball("around", center, around, DIFFUSE)];
    try_scene(&parts).expect("a right scene")
}

/// The segment lengths of a path in radii: into the glass, one reflection inside, out, and on to the sphere around it.
fn walk(scene: &Scene, radius: f64, [turn, place]: [f64; 2]) -> Option<[f64; 4]> {
    // Up to 0.99 of the radius from the axis: closer to the limb, the condition number of the lengths exceeds 1e3.
    let impact = 0.99 * place.sqrt() * radius;
    let origin = Vec3::new(impact * libm::cos(TAU * turn), impact * libm::sin(TAU * turn), 5.0 * radius);
    let mut ray = Ray { origin, direction: Vec3::new(0.0, 0.0, -1.0) };
    let (mut from, mut lengths) = (None, [0.0; 4]);
    for (length, u) in lengths.iter_mut().zip([0.99, 0.0, 0.99, 0.0]) {
        let hit = intersect(scene, &ray, from)?;
        *length = hit.t / radius;
        let (next, standpoint) = scatter(scene, &hit, ray.direction, u);
        (ray, from) = (Ray { direction: next.direction.normalized(), ..next }, Some(standpoint));
    }
    Some(lengths)
}

pub(super) fn tiny_glass(trials: &mut Trials) {
    let rays = trials.times(10_000, 1_000_000);
    let big = glass([0.0; 3], 16.5, 165.0);
    for radius in [4e-5, 1e-6] {
        let tiny = glass([0.0; 3], radius, 10.0 * radius);
        for (name, tiny) in searches(&tiny) {
            let mut random = Random::new(40);
            let (mut wrong, mut worst) = (0, 0.0_f64);
            for _ in 0..rays {
                let numbers = [random.unit(), random.unit()];
                let (expected, found) = (walk(&big, 16.5, numbers), walk(&tiny, radius, numbers));
                let Some((expected, found)) = expected.zip(found) else {
                    wrong += 1;
                    continue;
                };
                let error = expected.iter().zip(found).map(|(e, f)| (f / e - 1.0).abs()).fold(0.0, f64::max);
                worst = worst.max(error);
                wrong += u64::from(error.is_nan() || error > 1e-12);
            }
            let told = format!("{wrong} of {rays}, the worst by {worst:.1e}");
            let variant = format!("radius {radius:e}, accelerator {name}");
            trials.holds(variant, "0 lengths off by more than 1e-12 of themselves", told, wrong == 0);
        }
    }
}

/// Checks chords of `2 r cos`, from random points of a ball inwards, with cosines drawn by `cosine`. Each must end on
/// the ball, at the distance that geometry gives. The starting point is rounded, which turns the chord by the rounding
/// of its coordinates over the radius.
fn chords(
    trials: &mut Trials,
    scene: &Scene,
    (center, radius): (Vec3, f64),
    tolerance: f64,
    cosine: fn(&mut Random) -> f64,
) {
    let rays = trials.times(20_000, 2_000_000);
    for (name, scene) in searches(scene) {
        let mut random = Random::new(43);
        let (mut wrong, mut worst, mut lost) = (0, 0.0_f64, 0);
        for _ in 0..rays {
            let normal = random.direction();
            let frame = Frame::around(-normal);
            let cos = cosine(&mut random);
            let direction = frame.to_world(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)).normalized();
            let ray = Ray { origin: center + normal * radius, direction };
            let hit = intersect(&scene, &ray, Some(SurfaceOrigin { primitive: 0, inside: true }));
            let error = hit.filter(|hit| hit.primitive == 0).map_or(f64::NAN, |hit| (hit.t - 2.0 * radius * cos).abs());
            worst = worst.max(error);
            wrong += u64::from(error.is_nan() || error > tolerance);
            lost += u64::from(smallpt_first_root(ray.origin - center, direction, radius, SMALLPT_EPSILON) == 0.0);
        }
        let told = format!("{wrong} of {rays}, the worst by {worst:.1e}; smallpt's epsilon would lose {lost}");
        let variant = format!("radius {radius:e}, accelerator {name}");
        trials.holds(variant, format_args!("0 chords off by more than {tolerance:.1e}"), told, wrong == 0);
    }
}

pub(super) fn chords_in_glass(trials: &mut Trials) {
    for radius in [16.5, 4e-5, 1e-6] {
        let scene = glass([73.0, 40.0, 78.0], radius, 1e5);
        let center = Vec3::new(73.0, 40.0, 78.0);
        let tolerance = 2e-14 * radius + 4e-14;
        chords(trials, &scene, (center, radius), tolerance, |random| random.scale(-5.0, 0.0));
        chords(trials, &scene, (center, radius), tolerance, |_| 2e-6);
    }
}

/// A cosine law gives such short chords once in 4e18 bounces, so smallpt's epsilon does no harm here. This says
/// nothing about smaller spheres.
pub(super) fn chords_of_walls(trials: &mut Trials) {
    let parts = [ANY_CAMERA.into(), ball("left wall", [100_001.0, 40.8, 81.6], 1e5, DIFFUSE)];
    let scene = try_scene(&parts).expect("a right scene");
    let wall = (Vec3::new(100_001.0, 40.8, 81.6), 1e5);
    // A coordinate of 2e5 is rounded at 2^-36, and enters the chord twice.
    chords(trials, &scene, wall, 8.0 * U * 2e5, |random| random.scale(-9.3, -6.0));
}

/// The next ray segment and its standpoint, for a ray that arrives along `direction`. `u` chooses the lobe. The new
/// direction is not normalised.
pub(super) fn scatter(scene: &Scene, hit: &Hit, direction: Vec3, u: f64) -> (Ray, SurfaceOrigin) {
    let frame = hit.frame();
    let material: &Material = &scene.objects[hit.object as usize].material;
    let sample = material.sample::<AllEffects>(frame.to_local(-direction), hit.inside, [u, 0.5]);
    let wi = sample.expect("nothing here absorbs").wi;
    let inside = (wi.z < 0.0) != hit.inside;
    (Ray { origin: hit.point, direction: frame.to_world(wi) }, SurfaceOrigin { primitive: hit.primitive, inside })
}
