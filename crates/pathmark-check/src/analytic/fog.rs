//! Fog that absorbs, emits and scatters.

use crate::Trials;
use crate::exact::{Bench, arriving_estimators, every_estimator, mean};
use crate::stage::{camera, diffuse, fog, object, plane, scene, sphere};

/// A glowing plane at y = 0.
fn lamp(emission: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.0), [emission; 3])
}

fn above(height: f64) -> String {
    camera([0.0, height, 0.0], [0.0; 3])
}

/// Beer-Lambert law, down to the smallest values of f32 and f64. Nothing is random; only the width of the spot adds an
/// error.
pub(super) fn absorption(trials: &mut Trials) {
    for (tau, exact) in [
        (1.0, 0.367_879_441_171_442_33),
        (10.0, 4.539_992_976_248_485e-5),
        (88.0, 6.054_601_895_401_186e-39),
        (104.0, 6.813_556_821_545_299e-46),
        (700.0, 9.859_676_543_759_77e-305),
        (746.0, 0.0),
        (800.0, 0.0),
    ] {
        // Powers of two keep tau exact.
        for (sigma, height) in [(tau, 1.0), (tau / 4.0, 4.0)] {
            let scene = scene(&[above(height), fog(sigma, 0.0, 0.0), lamp(1.0)]);
            for (way, film) in Bench::new(trials).films(&scene, every_estimator(), 1024.0) {
                trials.close(format!("tau {tau} over {height}, {way}"), exact, mean(&film, 0).0, 1e-11 * exact);
            }
        }
    }
}

/// (j/sigma) (1 - exp(-tau)), also for tau so small that evaluating 1 - exp would lose half of the digits.
pub(super) fn emission(trials: &mut Trials) {
    for (tau, exact) in [(1e-9, 9.999_999_995e-10), (0.01, 0.009_950_166_250_831_947), (1.0, 0.632_120_558_828_557_7)] {
        let scene = scene(&[above(1.0), fog(tau, 0.0, 1.0), lamp(0.0)]);
        for (way, film) in Bench::new(trials).films(&scene, every_estimator(), 1024.0) {
            trials.close(format!("tau {tau}, {way}"), exact, mean(&film, 0).0, 1e-11 * exact);
        }
    }
    // Endless fog, with no object on the camera's rays.
    let ball = object(&sphere([0.0, 9.0, 0.0], 1.0), &diffuse(0.0), [0.0; 3]);
    let endless = scene(&["background = [0.0, 0.0, 0.0]\n".to_string(), above(1.0), fog(0.3, 0.0, 2.5), ball]);
    for (way, film) in Bench::new(trials).films(&endless, every_estimator(), 1024.0) {
        trials.same(format!("endless, {way}"), 2.5, mean(&film, 0).0);
    }
}

/// A ball transmits the share T of a parallel beam. By the cosine law, T is also the transmitted share of the light
/// from one point of the wall to all others: T = 0.296997 for sigma R = 1. So the wall of a hollow ball full of fog
/// has the radiance Le/(1 - rho T). The fog attenuates it on the way to the camera.
pub(super) fn ball(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let rho = 0.75;
    let wall = object(&sphere([0.0; 3], 1.0), &diffuse(rho), [1.0; 3]);
    let scene = scene(&[camera([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]), fog(1.0, 0.0, 0.0), wall]);
    let exact = libm::exp(-0.5) / (1.0 - rho * 0.296_997_075_145_080_96);
    bench.each("ball", &scene, arriving_estimators(), &[exact]);
    bench.max_depth = Some(1);
    let exact = libm::exp(-0.5) * (1.0 + rho * 0.296_997_075_145_080_96);
    bench.each("one bounce", &scene, arriving_estimators(), &[exact]);
}

/// The radiance is 1, however much the fog scatters, absorbs and emits.
pub(super) fn furnace(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (absorption, scattering) in [(0.0, 1.0), (0.0, 4.0), (0.5, 0.5), (2.0, 1.0)] {
        let wall = object(&sphere([0.0; 3], 1.0), &diffuse(0.25), [0.75; 3]);
        let at = camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]);
        let scene = scene(&[at, fog(absorption, scattering, 1.0), wall]);
        bench.each(&format!("{absorption}, {scattering}"), &scene, arriving_estimators(), &[1.0]);
    }
}
