//! Slabs of glass between two lamps.

use crate::Trials;
use crate::exact::{Bench, arriving_estimators, every_estimator, full_estimators};
use crate::scene::Scene;
use crate::stage::{camera, diffuse, object, plane, scene};

/// A slab of index 1.5 with a red lamp behind it and a green one in front, both also blue, seen at an angle to its
/// normal.
fn slab(degrees: f64, tint: f64, fresnel: &str) -> Scene {
    let glass = format!("{{ dielectric = {{ eta = 1.5, tint = {:?}, fresnel = \"{fresnel}\" }} }}", [tint; 3]);
    let up = [0.0, 1.0, 0.0];
    let (sin, cos) = (libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()));
    scene(&[
        camera([2.0 * sin, 1.0 + 2.0 * cos, 0.0], [0.0, 1.0, 0.0]),
        object(&plane([0.0, 1.0, 0.0], up), &glass, [0.0; 3]),
        object(&plane([0.0, 0.0, 0.0], [0.0, -1.0, 0.0]), &glass, [0.0; 3]),
        object(&plane([0.0, -1.0, 0.0], up), &diffuse(0.0), [1.0, 0.0, 1.0]),
        object(&plane([0.0, 5.0, 0.0], up), &diffuse(0.0), [0.0, 1.0, 1.0]),
    ])
}

/// T = 2n/(n^2 + 1) = 12/13 of the light behind it and R = 1/13 of the light in front, whichever formula gives the
/// reflected share.
pub(super) fn lossless(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    // The rarest of the three events decides.
    bench.widest = [5e-2, 1e-3];
    for fresnel in ["schlick", "exact"] {
        let exact = [0.923_076_923_076_923_1, 0.076_923_076_923_076_92, 1.0];
        bench.each(fresnel, &slab(0.0, 1.0, fresnel), every_estimator(), &exact);
    }
}

/// T = (1 - R)^2 A/(1 - R^2 A^2), and R(A) likewise, if each crossing transmits A = exp(-tau). Here the surfaces
/// absorb instead, each as much as one crossing. A path that is reflected k times inside crosses k + 1 times and meets
/// k + 2 surfaces, so both shares have one more factor A.
pub(super) fn absorbing(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (tau, transmitted, reflected, widest) in [
        (0.1, 0.834_991_978_239_793_7, 0.070_221_279_426_849_32, [3e-2, 1e-3]),
        (1.0, 0.339_111_122_903_388_15, 0.044_990_080_415_548_75, [6e-2, 1e-3]),
    ] {
        let a = libm::exp(-tau);
        bench.widest = widest;
        bench.each(&format!("tau {tau}"), &slab(0.0, a, "exact"), every_estimator(), &[a * transmitted, a * reflected]);
    }
    // So little light is left that roulette would end almost all paths.
    let a = libm::exp(-10.0);
    let exact = [a * 4.184_057_526_924_402_3e-5];
    bench.each("tau 10", &slab(0.0, a, "exact"), every_estimator().filter(|name| *name == "whitted"), &exact);
    bench.roulette = Some("never".to_string());
    bench.each("tau 10", &slab(0.0, a, "exact"), full_estimators(), &exact);
}

/// Each surface uses the mean of both polarisations, as renderers do. Light that stayed polarised between the surfaces
/// would give 0.9073, 0.8481 and 0.4585.
pub(super) fn slanted(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    for (degrees, exact) in
        [(45.0, 0.904_326_791_458_889), (60.0, 0.836_232_462_710_168), (80.0, 0.441_229_173_374_367)]
    {
        let scene = slab(degrees, 1.0, "exact");
        bench.each(&format!("{degrees} degrees"), &scene, arriving_estimators(), &[exact, 1.0 - exact, 1.0]);
    }
}
