//! Furnaces: closed scenes in which every surface glows, and smallpt's box.

use crate::exact::{Bench, arriving_estimators, critical, full_estimators, mean};
use crate::math::Vec3;
use crate::scene::load;
use crate::stage::{camera, diffuse, object, scene, sphere};
use crate::{Case, Trials};

pub(super) const CASES: &[Case] = &[
    Case { id: "A1", tries: "a closed sphere that glows: Le/(1 - rho)", run: glowing_wall },
    Case { id: "A2", tries: "smallpt's box in thermal equilibrium: 1 everywhere", run: equilibrium },
    Case { id: "A22", tries: "smallpt's box has smallpt's mean", run: smallpt_mean },
];

/// At the highest albedo, 0.999, a path has about a thousand vertices, so there is time for few samples only.
fn glowing_wall(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (rho, exact, widest) in [
        (0.1, 10.0 / 9.0, [1e-2, 1e-3]),
        (0.5, 2.0, [1e-2, 1e-3]),
        (0.75, 4.0, [1e-2, 1e-3]),
        (0.9, 10.0, [1e-2, 1e-3]),
        (0.99, 100.0, [5e-2, 3e-3]),
        (0.999, 1000.0, [1e-1, 1e-2]),
    ] {
        let wall = object(&sphere([0.0; 3], 1.0), &diffuse(rho), [1.0; 3]);
        let scene = scene(&[camera([0.1, 0.2, 0.3], [1.0, 0.0, 0.0]), wall]);
        bench.widest = widest;
        bench.each(&format!("rho {rho}"), &scene, arriving_estimators(), &[exact]);
        if rho == 0.75 {
            bench.each_sampler(&format!("rho {rho}"), &scene, &[exact]);
        }
    }
}

/// Rendered also from inside the glass, where a path starts on no surface: radiance is not scaled by the index
/// squared.
fn equilibrium(trials: &mut Trials) {
    let room = load("cornell").expect("a shipped scene").in_equilibrium();
    let mut inside = room.clone();
    (inside.camera.position, inside.camera.advance) = (Vec3::new(73.0, 16.5, 78.0), 0.0);
    let mut bench = Bench::new(trials);
    bench.by_pixel = false;
    for (place, scene) in [("room", &room), ("glass", &inside)] {
        bench.each(place, scene, arriving_estimators(), &[1.0; 3]);
    }
    bench.each_sampler("room", &room, &[1.0; 3]);
}

/// 0.3285 in linear radiance at 4:3, over pixels and channels. Evaluating the camera ray in another order makes the
/// camera see beyond the ceiling and gives 0.388: off by twice the permitted noise.
fn smallpt_mean(trials: &mut Trials) {
    let scene = load("cornell").expect("a shipped scene");
    let samples = trials.times(200_000, 12_000_000) as f64;
    let mut bench = Bench::new(trials);
    bench.size = [64, 48];
    for (way, film) in bench.films(&scene, full_estimators(), samples) {
        let channels = [0, 1, 2].map(|channel| mean(&film, channel));
        let found = channels.iter().map(|(mean, _)| mean / 3.0).sum::<f64>();
        // The largest error of a channel is an upper bound for the error of their mean.
        let width = critical() * channels.iter().map(|(_, error)| *error).fold(0.0, f64::max);
        trials.holds(
            way,
            "0.3285 +- 0.001 and noise of at most 0.03",
            format_args!("{found:.4} +- {width:.4}"),
            width < 0.03 && (found - 0.3285).abs() < 1e-3 + width,
        );
    }
}
