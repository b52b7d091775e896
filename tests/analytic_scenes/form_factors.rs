//! Lights with a size, over planes and in boxes.

use super::estimate::{arriving_estimators, assert_exact, camera, diffuse, object, plane, render, scene, sphere, view};
use super::unsplit_estimators;
use std::f64::consts::FRAC_1_PI;

fn floor(albedo: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(albedo), [0.0; 3])
}

fn quad(corners: [[f64; 3]; 4]) -> String {
    format!("{{ quad = {{ corners = {corners:?} }} }}")
}

/// A6: a sphere of radius a over a plane: rho Le (a/d)^2 cos, exact at any distance while all of it is above the horizon.
#[test]
fn sphere_over_a_plane() {
    let cases = [
        (1.0, 2.0, 0.0, 0.125, 6_000_000),
        // cos is 2/sqrt 5, and d^2 is 5.
        (1.0, 2.0, 1.0, 0.089_442_719_099_991_59, 8_000_000),
        // Two rays in ten thousand pass below it.
        (1.0, 1.000_1, 0.0, 0.499_900_014_998_000_25, 1_000_000),
    ];
    for (radius, height, x, exact, samples) in cases {
        // The camera is so low that it sees the spot below the lowest ball.
        let light = object(&sphere([0.0, height, 0.0], radius), &diffuse(0.0), [1.0; 3]);
        let scene = scene(&[camera([x + 3.0, 0.02, 0.0], [x, 0.0, 0.0]), floor(0.5), light]);
        for estimator in unsplit_estimators() {
            let outcome = render(&scene, estimator, samples, None);
            assert_exact(&format!("h {height}, x {x}, {estimator}"), &outcome, 0, exact, 12);
        }
    }
}

/// A8: a unit square over a plane, below one of its corners, by Lambert's formula for polygons.
#[test]
fn square_over_a_plane() {
    let corners = [[-0.5, 1.0, -0.5], [0.5, 1.0, -0.5], [0.5, 1.0, 0.5], [-0.5, 1.0, 0.5]];
    let light = object(&quad(corners), &diffuse(0.0), [1.0; 3]);
    let scene = scene(&[camera([3.0, 0.5, 0.0], [0.5, 0.0, 0.5]), floor(0.5), light]);
    for estimator in unsplit_estimators() {
        let outcome = render(&scene, estimator, 10_000_000, None);
        assert_exact(estimator, &outcome, 0, 0.5 * FRAC_1_PI * 0.435_209_875_683_558_74, 4);
    }
}

/// A10: the faces of a cube. A camera in the middle sees one face evenly, and no more; the face opposite glows red, one beside it green,
/// all of them blue.
#[test]
fn faces_of_a_cube() {
    let face = |axis: usize, side: f64, material: &str, emission: [f64; 3]| {
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[u, v]| {
            let mut corner = [side; 3];
            (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (u, v);
            corner
        });
        object(&quad(corners), material, emission)
    };
    let black = diffuse(0.0);
    let parts = [
        view([0.0; 3], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], 90.0),
        face(1, -0.5, &diffuse(1.0), [0.0; 3]),
        face(1, 0.5, &black, [1.0, 0.0, 1.0]),
        face(0, 0.5, &black, [0.0, 1.0, 1.0]),
        face(0, -0.5, &black, [0.0, 0.0, 1.0]),
        face(2, 0.5, &black, [0.0, 0.0, 1.0]),
        face(2, -0.5, &black, [0.0, 0.0, 1.0]),
    ];
    // Corners of the cube are so near to the light that aiming alone has no bound there.
    for estimator in unsplit_estimators().filter(|name| *name != "nee") {
        let outcome = render(&scene(&parts), estimator, 7_200_000, None);
        for (channel, exact) in [0.199_824_895_698_387_38, 0.200_043_776_075_403_15, 1.0].into_iter().enumerate() {
            assert_exact(&format!("channel {channel}, {estimator}"), &outcome, channel, exact, 12);
        }
    }
}

/// A11: parallel plates, one of which glows: Le/(1 - r1 r2) and r2 Le/(1 - r1 r2).
#[test]
fn parallel_plates() {
    let lower = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [1.0; 3]);
    let upper = object(&plane([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), &diffuse(0.8), [0.0; 3]);
    for (y, exact) in [(0.0, 5.0 / 3.0), (1.0, 4.0 / 3.0)] {
        let scene = scene(&[camera([0.0, 0.5, 0.0], [0.3, y, 0.0]), lower.clone(), upper.clone()]);
        for estimator in arriving_estimators() {
            let outcome = render(&scene, estimator, 400_000, None);
            assert_exact(&format!("y {y}, {estimator}"), &outcome, 0, exact, 8);
        }
    }
}

/// A12: a ball under half a sky: rho (1 + cos beta)/2, where beta is the angle between its normal and upwards.
#[test]
fn ball_under_half_a_sky() {
    let earth = object(&plane([0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), &diffuse(0.0), [0.0; 3]);
    let ball = object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [0.0; 3]);
    for (degrees, sky, samples) in
        [(0.0, 1.0, 4096), (60.0, 0.75, 800_000), (90.0, 0.5, 2_000_000), (120.0, 0.25, 6_000_000), (180.0, 0.0, 4096)]
    {
        let cos: f64 = 2.0 * sky - 1.0;
        let sin = (1.0 - cos * cos).sqrt();
        let background = "background = [1.0, 1.0, 1.0]\n".to_string();
        let at = camera([4.0 * sin, 4.0 * cos, 0.0], [0.0; 3]);
        let scene = scene(&[background, at, earth.clone(), ball.clone()]);
        for estimator in unsplit_estimators() {
            let outcome = render(&scene, estimator, samples, None);
            assert_exact(&format!("beta {degrees}, {estimator}"), &outcome, 0, 0.5 * sky, 20);
        }
    }
}
