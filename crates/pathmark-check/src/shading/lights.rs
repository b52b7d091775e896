//! Lights that contribute little or nothing, and very many lights: H37.

use crate::Trials;
use crate::estimator::ESTIMATORS;
use crate::kernel::KERNELS;
use crate::rendering::{Moments, run, spec};
use crate::scene::load;
use crate::stage::{camera, diffuse, object, plane, scene, sphere};

/// Points that none of these lights reaches are black, and no sample is NaN.
pub(super) fn hardly_there(trials: &mut Trials) {
    let floor = || object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    let lamp = |y: f64| object(&sphere([0.7, y, 0.0], 0.5), &diffuse(0.0), [3.0; 3]);
    // A square that stands on the floor: the visible point lies in its plane.
    let edge_on = "{ quad = { corners = [[0.5, 0.0, 0.0], [1.5, 0.0, 0.0], [1.5, 1.0, 0.0], [0.5, 1.0, 0.0]] } }";
    let hood = |y: f64| object(&sphere([0.7, y, 0.0], 0.8), &diffuse(0.5), [0.0; 3]);
    let spots = [
        ("below the horizon", vec![floor(), lamp(-2.0)]),
        ("touching the horizon from below", vec![floor(), lamp(-0.5)]),
        ("edge on", vec![floor(), object(edge_on, &diffuse(0.0), [3.0; 3])]),
        ("inside of what is opaque", vec![floor(), lamp(2.0), hood(2.0)]),
        ("dark", vec![floor(), object(&sphere([0.0, 2.0, 0.0], 0.5), &diffuse(0.0), [0.0; 3])]),
    ];
    let spp = trials.times(16, 512) as u32;
    for (name, things) in spots {
        let parts = ["background = [0.0, 0.0, 0.0]\n".to_string(), camera([2.0, 1.5, 1e-3], [0.0; 3])];
        let scene = scene(&[parts.concat(), things.concat()]);
        for kernel in KERNELS {
            for entry in ESTIMATORS {
                let outcome = run(&scene, spec(entry.name, kernel.name, [16; 2], 50), spp);
                let variant = format!("{name}, {}, {}", kernel.name, entry.name);
                trials.same(format!("{variant}: invalid samples"), &0, &outcome.counts.invalid);
                let brightest = (0..3).map(|channel| Moments::of(&outcome.film, channel).mean).fold(0.0, f64::max);
                // The camera sees a spot rather than a point: edge on, its points are up to 3e-8 off the plane of the
                // light.
                trials.at_most(format!("{variant}: radiance"), if name == "edge on" { 1e-6 } else { 0.0 }, brightest);
            }
        }
    }
    chances(trials);
}

/// Every one of very many lights can be chosen, and the probabilities sum to 1. A surface that emits nothing is no
/// light.
fn chances(trials: &mut Trials) {
    let scene = load("spheres:100000").expect("a shipped scene").in_equilibrium();
    let scene = scene.lit(&scene.camera.view(8, 6));
    let chances: Vec<f64> = scene.lights.as_ref().map(|lights| lights.chances().collect()).unwrap_or_default();
    trials.same("lights", &100_000, &chances.len());
    trials.close("sum of the chances", 1.0, chances.iter().sum(), 1e-11);
    // Half of the choices are uniform over the lights.
    trials.at_least("smallest chance", 0.499_999_999e-5, chances.iter().copied().fold(f64::INFINITY, f64::min));
    let dark = load("spheres:100").expect("a shipped scene");
    let lit = dark.lit(&dark.camera.view(8, 6));
    let lamps = dark.owners.iter().filter(|owner| !dark.objects[**owner as usize].emission.is_black()).count();
    let found = lit.lights.map_or(0, |lights| lights.chances().count());
    trials.holds("lights among 100 spheres", format_args!("at most {lamps}"), found, found <= lamps);
}
