//! Area lights, point lights and skies over planes, and parallel plates.

use crate::Trials;
use crate::exact::{Bench, aiming_estimators, arriving_estimators, every_estimator, unsplit_estimators};
use crate::shading::balance::{ALBEDO, COSINES};
use crate::stage::{camera, diffuse, object, plane, point_light, quad, scene, sphere};
use std::f64::consts::{FRAC_1_PI, PI};

fn floor(albedo: f64) -> String {
    object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(albedo), [0.0; 3])
}

/// rho Le (a/d)^2 cos, exact at any distance while the whole light is above the horizon. Where at most one path in
/// fifty hits the light, only the estimators that aim at it are checked.
pub(super) fn sphere_over_a_plane(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (radius, height, x, exact) in [
        (0.5, 2.0, 0.0, 0.031_25),
        (0.5, 2.0, 1.0, 0.022_360_679_774_997_897),
        (0.5, 2.0, 10.0, 2.357_165_085_795_481e-4),
        (1e-3, 1.0, 0.0, 5e-7),
        (1.0, 2.0, 0.0, 0.125),
        (1.0, 2.0, 1.0, 0.089_442_719_099_991_59),
        // Two rays in ten thousand pass below it.
        (1.0, 1.000_1, 0.0, 0.499_900_014_998_000_25),
    ] {
        // The camera is so low that it sees the spot below the lowest ball.
        let light = object(&sphere([0.0, height, 0.0], radius), &diffuse(0.0), [1.0; 3]);
        let scene = scene(&[camera([x + 3.0, 0.02, 0.0], [x, 0.0, 0.0]), floor(0.5), light]);
        let what = format!("a {radius}, h {height}, x {x}");
        bench.rare = height < 1.1;
        bench.widest = [2e-2, 1e-3];
        bench.each(&what, &scene, aiming_estimators(), &[exact]);
        if exact > 0.02 {
            bench.widest = if exact > 0.1 { [2e-2, 2e-3] } else { [4e-2, 4e-3] };
            bench.each(&what, &scene, unsplit_estimators().filter(|name| *name == "bsdf"), &[exact]);
            bench.each_sampler(&what, &scene, &[exact]);
        }
    }
}

/// rho E/pi, with E by Lambert's formula for polygons.
pub(super) fn square_over_a_plane(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let light = |[x, z]: [f64; 2], y: f64| {
        let corners = [[-x, y, -z], [x, y, -z], [x, y, z], [-x, y, z]];
        object(&quad(corners), &diffuse(0.0), [1.0; 3])
    };
    let unit = light([0.5, 0.5], 1.0);
    for (what, light, at, spot, irradiance) in [
        ("below the middle", unit.clone(), [3.0, 0.5, 0.0], [0.0; 3], 0.752_274_688_454_107_5),
        ("below a corner", unit.clone(), [3.0, 0.5, 0.0], [0.5, 0.0, 0.5], 0.435_209_875_683_558_74),
        ("three beside it", unit, [5.0, 0.5, 0.0], [3.0, 0.0, 0.0], 0.010_575_258_639_667_599),
        ("the Cornell box's", light([65.0, 52.5], 548.8), [300.0, 60.0, 0.0], [0.0; 3], 0.044_632_474_668_127_83),
    ] {
        let scene = scene(&[camera(at, spot), floor(0.5), light]);
        let exact = 0.5 * FRAC_1_PI * irradiance;
        bench.widest = [2e-2, 1e-3];
        bench.each(what, &scene, aiming_estimators(), &[exact]);
        if irradiance > 0.4 {
            bench.widest = [2e-2, 2e-3];
            bench.each(what, &scene, unsplit_estimators().filter(|name| *name == "bsdf"), &[exact]);
        }
    }
}

/// Le/(1 - r1 r2) and r2 Le/(1 - r1 r2).
pub(super) fn parallel_plates(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let lower = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [1.0; 3]);
    let upper = object(&plane([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]), &diffuse(0.8), [0.0; 3]);
    for (y, exact) in [(0.0, 5.0 / 3.0), (1.0, 4.0 / 3.0)] {
        let scene = scene(&[camera([0.0, 0.5, 0.0], [0.3, y, 0.0]), lower.clone(), upper.clone()]);
        bench.each(&format!("y {y}"), &scene, arriving_estimators(), &[exact]);
    }
}

/// rho (1 + cos beta)/2, where beta is the angle between the ball's normal and the upward direction.
pub(super) fn ball_under_half_a_sky(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let earth = object(&plane([0.0, -5.0, 0.0], [0.0, 1.0, 0.0]), &diffuse(0.0), [0.0; 3]);
    let ball = object(&sphere([0.0; 3], 1.0), &diffuse(0.5), [0.0; 3]);
    for (degrees, sky) in [(0.0, 1.0), (60.0, 0.75), (90.0, 0.5), (120.0, 0.25), (180.0, 0.0)] {
        let cos: f64 = 2.0 * sky - 1.0;
        let sin = (1.0 - cos * cos).sqrt();
        let background = "background = [1.0, 1.0, 1.0]\n".to_string();
        let at = camera([4.0 * sin, 4.0 * cos, 0.0], [0.0; 3]);
        let scene = scene(&[background, at, earth.clone(), ball.clone()]);
        bench.widest = [2e-2, 1e-3];
        bench.each(&format!("beta {degrees}"), &scene, unsplit_estimators(), &[0.5 * sky]);
    }
}

pub(super) fn light_over_a_plane(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    for (x, exact) in [(0.0, 0.159_154_943_091_895_34), (1.0, 0.056_269_769_759_819_14)] {
        let at = camera([0.0, 3.0, 1.0], [x, 0.0, 0.0]);
        let scene = scene(&[at, point_light([0.0, 1.0, 0.0], 1.0), floor.clone()]);
        bench.each(&format!("x {x}"), &scene, every_estimator(), &[exact]);
    }
    // Doubling the distance leaves a quarter of the light, from near to far.
    for height in [0.25, 0.5, 8.0, 512.0] {
        let at = camera([0.0, 0.1, 0.1], [0.0; 3]);
        let scene = scene(&[at, point_light([0.0, height, 0.0], 1.0), floor.clone()]);
        let exact = 0.5 * FRAC_1_PI / (height * height);
        bench.each(&format!("height {height}"), &scene, every_estimator(), &[exact]);
    }
    // Lights add up, each is occluded separately, and a light below the floor does not light its upper side.
    let parts = [
        camera([0.0, 0.5, 0.5], [0.0; 3]),
        point_light([0.0, 1.0, 0.0], 1.0),
        point_light([0.0, 2.0, 0.0], 2.0),
        point_light([2.0, 2.0, 0.0], 1000.0), // behind the ball
        point_light([0.0, -1.0, 0.0], 1000.0),
        floor,
        object(&sphere([1.0, 1.0, 0.0], 0.25), &diffuse(0.0), [0.0; 3]),
    ];
    bench.each("several", &scene(&parts), every_estimator(), &[0.5 / PI * (1.0 + 2.0 / 4.0)]);
}

/// A metal plane, seen at several angles.
pub(super) fn metal_under_a_sky(trials: &mut Trials) {
    let fewest = trials.times(8192, 10_000_000) as f64;
    let mut bench = Bench::new(trials);
    bench.fewest = fewest;
    // Case H26 holds the same table more closely; this one guards the way into a render.
    bench.widest = [2e-2, 1e-3];
    for (alpha, row) in ALBEDO {
        // Smooth metal loses only the few reflections that leave below the horizon.
        bench.rare = alpha < 0.1;
        let metal = format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 1.0, 1.0] }} }}");
        for (cos, exact) in COSINES.into_iter().zip(row) {
            let sin = f64::sqrt(1.0 - cos * cos);
            let scene = scene(&[
                "background = [1.0, 1.0, 1.0]\n".to_string(),
                camera([10.0 * sin, 10.0 * cos, 0.0], [0.0; 3]),
                object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &metal, [0.0; 3]),
            ]);
            bench.each(&format!("alpha {alpha}, cos {cos}"), &scene, unsplit_estimators(), &[exact]);
        }
    }
}
