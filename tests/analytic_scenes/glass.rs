//! Clear glass and mirrors.

use super::estimate::{arriving_estimators, assert_exact, camera, diffuse, mean, object, plane, render, scene, sphere};

/// A14: a lossless slab of glass, straight through: T = 2n/(n^2 + 1) = 12/13 of the light behind it and R = 1/13 of that before it.
#[test]
fn slab() {
    let glass = "{ dielectric = { eta = 1.5, tint = [1.0, 1.0, 1.0] } }";
    let up = [0.0, 1.0, 0.0];
    let scene = scene(&[
        camera([0.0, 3.0, 0.0], [0.0; 3]),
        object(&plane([0.0, 1.0, 0.0], up), glass, [0.0; 3]),
        object(&plane([0.0, 0.0, 0.0], [0.0, -1.0, 0.0]), glass, [0.0; 3]),
        object(&plane([0.0, -1.0, 0.0], up), &diffuse(0.0), [1.0, 0.0, 1.0]),
        object(&plane([0.0, 5.0, 0.0], up), &diffuse(0.0), [0.0, 1.0, 1.0]),
    ]);
    for estimator in arriving_estimators() {
        let outcome = render(&scene, estimator, 3_000_000, None);
        for (channel, exact) in [12.0 / 13.0, 1.0 / 13.0, 1.0].into_iter().enumerate() {
            assert_exact(&format!("channel {channel}, {estimator}"), &outcome, channel, exact, 9);
        }
    }
    // Each way through the slab and back keeps 0.04^2; ten bounces leave less than what rounding hides.
    let outcome = render(&scene, "whitted", 4096, None);
    for (channel, exact) in [12.0 / 13.0, 1.0 / 13.0, 1.0].into_iter().enumerate() {
        assert_exact(&format!("channel {channel}, whitted"), &outcome, channel, exact, 9);
    }
}

/// Report C's reflectivity of 80 %: in a closed sphere each bounce keeps 0.8 of the light, so an image that is cut after k arrivals misses
/// exactly 0.8^k of it.
#[test]
fn what_the_cut_misses() {
    let mirror = "{ polished = { albedo = [0.0, 0.0, 0.0], reflectivity = 0.8 } }";
    let scene = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), object(&sphere([0.0; 3], 1.0), mirror, [1.0; 3])]);
    let whole = 1.0 / (1.0 - 0.8);
    let mut missing = 1.0;
    for arrivals in 1..=33 {
        missing *= 0.8;
        let outcome = render(&scene, "whitted", 4096, Some(arrivals - 1));
        assert_eq!(outcome.counts.truncated, outcome.counts.paths);
        let (found, _) = mean(&outcome, 0);
        let missed = (whole - found) / whole;
        assert!((missed - missing).abs() < 1e-12, "{arrivals} arrivals miss {missed}, not {missing}");
    }
    // Ten bounces, the default, are eleven arrivals.
    let (found, _) = mean(&render(&scene, "whitted", 4096, None), 0);
    assert!((found / whole - (1.0 - 0.085_899_345_92)).abs() < 1e-12, "{found}");
}

/// The same between parallel mirrors, one of which glows: the sum over the ways there and back, r1 r2 = 0.4 each.
#[test]
fn parallel_mirrors() {
    let mirror = |share: f64| format!("{{ mirror = {{ albedo = {:?} }} }}", [share; 3]);
    let scene = scene(&[
        camera([0.0, 0.5, 0.0], [0.3, 0.0, 0.0]),
        object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &mirror(0.5), [1.0; 3]),
        object(&plane([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), &mirror(0.8), [0.0; 3]),
    ]);
    for ways in 0..8_u16 {
        // 1 + 0.4 + .. + 0.4^ways
        let sum = (0..=ways).rev().fold(0.0, |sum, _| 1.0 + 0.4 * sum);
        let (found, _) = mean(&render(&scene, "whitted", 4096, Some(2 * ways)), 0);
        assert!((found / sum - 1.0).abs() < 1e-13, "{ways} ways: {found} instead of {sum}");
    }
}
