//! Closed scenes: furnaces, in which every surface glows, smallpt's box, and spheres. In a sphere all pairs of points
//! have the same form factor, so indirect light is the same everywhere.

use crate::Trials;
use crate::exact::{
    Bench, aiming_estimators, arriving_estimators, critical, full_estimators, mean, unsplit_estimators,
};
use crate::math::Vec3;
use crate::scene::load;
use crate::stage::{camera, diffuse, hollow, object, point_light, scene, sphere};
use std::f64::consts::PI;

/// At the highest albedo, 0.999, a path has about a thousand vertices, so there is time for few samples only.
pub(super) fn glowing_wall(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let plain = (bench.size, bench.fewest);
    for (rho, exact, widest) in [
        (0.1, 10.0 / 9.0, [1e-2, 1e-3]),
        (0.5, 2.0, [1e-2, 1e-3]),
        (0.75, 4.0, [1e-2, 1e-3]),
        (0.9, 10.0, [1e-2, 1e-3]),
        (0.99, 100.0, [5e-2, 3e-3]),
        (0.999, 1000.0, [1e-1, 1e-2]),
    ] {
        let scene = hollow(&diffuse(rho), [1.0; 3]);
        bench.widest = widest;
        // Ten per cent need some three thousand samples of a thousand vertices each.
        (bench.size, bench.fewest) = if rho > 0.99 { ([16, 16], 2048.0) } else { plain };
        bench.each(&format!("rho {rho}"), &scene, arriving_estimators(), &[exact]);
        if rho == 0.75 {
            bench.each_sampler(&format!("rho {rho}"), &scene, &[exact]);
        }
    }
}

/// Rendered also from inside the glass, where a path starts on no surface: radiance is not scaled by the index
/// squared.
pub(super) fn equilibrium(trials: &mut Trials) {
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
pub(super) fn smallpt_mean(trials: &mut Trials) {
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

fn wall(radius: f64, albedo: f64) -> String {
    object(&sphere([0.0; 3], radius), &diffuse(albedo), [0.0; 3])
}

/// rho I/(pi R^2 (1 - rho)). The intensity pi in a unit sphere of albedo 1/2 gives exactly 1.
pub(super) fn light_in_the_middle(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (radius, rho) in [(1.0, 0.5), (2.0, 0.8)] {
        let at = camera([0.1, 0.2, 0.3], [radius, 0.0, 0.0]);
        let scene = scene(&[at, point_light([0.0; 3], PI), wall(radius, rho)]);
        bench.each(&format!("radius {radius}"), &scene, full_estimators(), &[1.0]);
    }
}

/// rho k Le/(1 - rho (1 - k)) with k = (a/R)^2: the source blocks a share k of the wall's light. Paths hit the
/// smallest source too rarely for the time that a test has.
pub(super) fn integrating_sphere(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (a, rho, emission, exact) in
        [(0.5, 0.5, 1.0, 0.2), (0.1, 0.8, 10.0, 0.384_615_384_615_384_6), (0.01, 0.98, 1000.0, 4.876_107_075_330_879)]
    {
        let source = object(&sphere([0.0; 3], a), &diffuse(0.0), [emission; 3]);
        let scene = scene(&[camera([0.0, 0.75, 0.0], [0.6, 0.8, 0.0]), wall(1.0, rho), source]);
        bench.widest = if a > 0.01 { [2e-2, 1e-3] } else { [3e-2, 3e-3] };
        bench.each(&format!("a {a}"), &scene, aiming_estimators(), &[exact]);
        if a > 0.01 {
            bench.widest = if a > 0.1 { [2e-2, 2e-3] } else { [5e-2, 5e-3] };
            bench.each(&format!("a {a}"), &scene, unsplit_estimators().filter(|name| *name == "bsdf"), &[exact]);
        }
        if a == 0.5 {
            bench.each_sampler(&format!("a {a}"), &scene, &[exact]);
        }
    }
}

/// (rho/pi) [cos/d^2 + rho/(1 - rho)]: indirect light is the same everywhere, direct light varies.
pub(super) fn light_off_the_middle(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let (near, far, equator) = ([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    for (z, rho, spot, exact) in [
        (0.5, 0.5, near, 0.795_774_715_459_476_7),
        (0.5, 0.5, far, 0.229_890_473_354_959_93),
        (0.5, 0.5, equator, 0.273_036_950_038_643_66),
        (0.9, 0.8, near, 26.483_382_530_491_384),
        (0.9, 0.8, far, 1.089_131_222_754_067),
        (0.9, 0.8, equator, 1.123_165_282_238_080_8),
    ] {
        let at = camera([0.1, 0.3, 0.2], spot);
        let scene = scene(&[at, point_light([0.0, 0.0, z], 1.0), wall(1.0, rho)]);
        // Near the light the wall is so bright that light from there is rare and strong.
        bench.widest = if z > 0.5 && exact < 2.0 { [3e-2, 3e-3] } else { [2e-2, 1e-3] };
        bench.each(&format!("z {z}, {spot:?}"), &scene, unsplit_estimators(), &[exact]);
    }
}
