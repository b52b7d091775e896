//! Corridors of mirrors that face each other.

use crate::Trials;
use crate::exact::{Bench, every_estimator, full_estimators};
use crate::scene::Scene;
use crate::stage::{camera, diffuse, hollow, mirror, object, plane, scene};

/// Two mirrors at distance 1 and a lamp across the corridor at distance `bounces`: a ray at 45 degrees is reflected
/// `bounces` times.
pub(crate) fn corridor(bounces: u32, albedo: f64) -> Scene {
    let up = [0.0, 1.0, 0.0];
    scene(&[
        camera([0.0, 0.5, 0.0], [1.0, 1.5, 0.0]),
        object(&plane([0.0; 3], up), &mirror(albedo), [0.0; 3]),
        object(&plane([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), &mirror(albedo), [0.0; 3]),
        object(&plane([f64::from(bounces), 0.0, 0.0], [-1.0, 0.0, 0.0]), &diffuse(0.0), [1.0; 3]),
        object(&plane([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &diffuse(0.0), [0.0; 3]),
    ])
}

pub(super) fn chains(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    // Nothing is random except roulette, in the corridor of 8 mirrors.
    (bench.size, bench.fewest) = ([4, 4], 64.0);
    bench.roulette = Some("never".to_string());
    for (bounces, albedo, exact) in
        [(1, 0.5, 0.5), (30, 0.5, 1.0 / f64::from(1 << 30)), (10_000, 0.999, 4.517_334_597_704_865e-5)]
    {
        let what = format!("{bounces} mirrors of {albedo}");
        bench.each(&what, &corridor(bounces, albedo), full_estimators(), &[exact]);
    }
    bench.roulette = None;
    bench.widest = [5e-2, 2e-3];
    bench.each("8 mirrors of 0.5, by chance", &corridor(8, 0.5), full_estimators(), &[1.0 / 256.0]);
    // A depth limit in a closed mirror keeps the first terms of 1 + rho + rho^2 ..
    let polished = "{ polished = { albedo = [0.0, 0.0, 0.0], reflectivity = 0.8 } }";
    let hollow = hollow(polished, [1.0; 3]);
    for depth in [0, 1, 4, 10, 32] {
        bench.max_depth = Some(depth);
        let exact = (0..=depth).rev().fold(0.0, |sum, _| 1.0 + 0.8 * sum);
        let whitted = every_estimator().filter(|name| *name == "whitted");
        bench.each(&format!("a closed mirror, {depth} bounces"), &hollow, whitted, &[exact]);
    }
    // Two parallel mirrors, one of which glows: a sum over round trips, each with the factor 0.4.
    let glowing = scene(&[
        camera([0.0, 0.5, 0.0], [0.3, 0.0, 0.0]),
        object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &mirror(0.5), [1.0; 3]),
        object(&plane([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), &mirror(0.8), [0.0; 3]),
    ]);
    for ways in [0, 1, 7] {
        bench.max_depth = Some(2 * ways);
        let exact = (0..=ways).rev().fold(0.0, |sum, _| 1.0 + 0.4 * sum);
        bench.each(&format!("parallel mirrors, {ways} ways"), &glowing, every_estimator(), &[exact]);
    }
}
