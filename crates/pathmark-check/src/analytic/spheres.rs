//! Interiors of closed spheres: all pairs of points have the same form factor, so indirect light is the same
//! everywhere.

use crate::exact::{Bench, aiming_estimators, full_estimators, unsplit_estimators};
use crate::stage::{camera, diffuse, object, point_light, scene, sphere};
use crate::{Case, Trials};
use std::f64::consts::PI;

pub(super) const CASES: &[Case] = &[
    Case { id: "A3", tries: "a point light in the middle of a sphere", run: light_in_the_middle },
    Case { id: "A4", tries: "an integrating sphere with a black source", run: integrating_sphere },
    Case { id: "A5", tries: "a point light off the middle of a sphere", run: light_off_the_middle },
];

fn hollow(radius: f64, albedo: f64) -> String {
    object(&sphere([0.0; 3], radius), &diffuse(albedo), [0.0; 3])
}

/// rho I/(pi R^2 (1 - rho)). The intensity pi in a unit sphere of albedo 1/2 gives exactly 1.
fn light_in_the_middle(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (radius, rho) in [(1.0, 0.5), (2.0, 0.8)] {
        let at = camera([0.1, 0.2, 0.3], [radius, 0.0, 0.0]);
        let scene = scene(&[at, point_light([0.0; 3], PI), hollow(radius, rho)]);
        bench.each(&format!("radius {radius}"), &scene, full_estimators(), &[1.0]);
    }
}

/// rho k Le/(1 - rho (1 - k)) with k = (a/R)^2: the source blocks a share k of the wall's light. Paths hit the
/// smallest source too rarely for the time that a test has.
fn integrating_sphere(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (a, rho, emission, exact) in
        [(0.5, 0.5, 1.0, 0.2), (0.1, 0.8, 10.0, 0.384_615_384_615_384_6), (0.01, 0.98, 1000.0, 4.876_107_075_330_879)]
    {
        let source = object(&sphere([0.0; 3], a), &diffuse(0.0), [emission; 3]);
        let scene = scene(&[camera([0.0, 0.75, 0.0], [0.6, 0.8, 0.0]), hollow(1.0, rho), source]);
        bench.widest = if a > 0.01 { [1e-2, 1e-3] } else { [3e-2, 3e-3] };
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
fn light_off_the_middle(trials: &mut Trials) {
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
        let scene = scene(&[at, point_light([0.0, 0.0, z], 1.0), hollow(1.0, rho)]);
        // Near the light the wall is so bright that light from there is rare and strong.
        bench.widest = if z > 0.5 && exact < 2.0 { [3e-2, 3e-3] } else { [1e-2, 1e-3] };
        bench.each(&format!("z {z}, {spot:?}"), &scene, unsplit_estimators(), &[exact]);
    }
}
