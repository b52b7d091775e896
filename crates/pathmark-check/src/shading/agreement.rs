//! Agreement of the estimators with each other and with closed forms: H35, H36.

use crate::exact::full_estimators;
use crate::kernel::KERNELS;
use crate::rendering::{Moments, difference, exact, run, spec};
use crate::scene::Scene;
use crate::stage::{camera, diffuse, object, plane, scene, sphere};
use crate::{Trials, critical};

/// A scene of a spot, with its radiance if there is a closed form.
struct Spot {
    name: &'static str,
    scene: Scene,
    radiance: Option<f64>,
}

const GLASS: &str = "{ dielectric = { eta = 1.5, tint = [1.0, 1.0, 1.0], fresnel = 'exact' } }";
const SIDE: u32 = 16;

/// Compares every estimator that follows all light, with every kernel, with the closed form and with each of the
/// others.
fn agree(trials: &mut Trials, spots: &[Spot], spp: (u64, u64), widest: f64) {
    let estimators: Vec<&str> = full_estimators().collect();
    let ways: Vec<(&str, &str)> =
        KERNELS.iter().flat_map(|kernel| estimators.iter().map(|estimator| (kernel.name, *estimator))).collect();
    let limit = critical(spots.len() * ways.len() * (ways.len() + 1) / 2);
    let spp = trials.times(spp.0, spp.1) as u32;
    for Spot { name, scene, radiance } in spots {
        let found: Vec<(String, Moments)> = (40..)
            .zip(&ways)
            .map(|(seed, (kernel, estimator))| {
                let outcome = run(scene, spec(estimator, kernel, [SIDE; 2], seed), spp);
                trials.same(format!("{name}, {kernel}, {estimator}: invalid samples"), &0, &outcome.counts.invalid);
                (format!("{kernel}, {estimator}"), Moments::of(&outcome.film, 0))
            })
            .collect();
        for (index, (way, moments)) in found.iter().enumerate() {
            if let Some(radiance) = radiance {
                exact(trials, &format!("{name}, {way}"), *radiance, moments, limit, widest);
            }
            for (other, others) in &found[..index] {
                trials.deviates_below(format!("{name}, {way} against {other}"), limit, difference(moments, others));
            }
        }
    }
}

/// A lamp of radius R at height h above a point of a floor gives the radiance albedo L (R/h)². Its area is 1e-6; its
/// centre is 0.0006 above.
pub(super) fn lights(trials: &mut Trials) {
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    let (radius, height) = (0.000_282_094_791_773_878_16, 6e-4);
    let dark = "background = [0.0, 0.0, 0.0]\n".to_string();
    let camera = |reach: f64| camera([reach, 0.8 * reach, 0.0], [0.0; 3]);
    let spots = [
        Spot {
            name: "area 1e-6",
            scene: scene(&[
                dark.clone(),
                camera(0.002),
                floor.clone(),
                object(&sphere([0.0, height, 0.0], radius), &diffuse(0.0), [3.0; 3]),
            ]),
            radiance: Some(1.5 * (radius / height) * (radius / height)),
        },
        Spot {
            name: "hemisphere",
            scene: scene(&[
                camera(1.0),
                object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]),
                object(&sphere([0.0; 3], 10.0), &diffuse(0.0), [3.0; 3]),
            ]),
            radiance: Some(1.5),
        },
        Spot {
            name: "half below the horizon",
            scene: scene(&[dark, camera(2.0), floor, object(&sphere([1.5, 0.0, 0.0], 1.0), &diffuse(0.0), [3.0; 3])]),
            radiance: None,
        },
    ];
    agree(trials, &spots, (256, 8192), 0.08);
}

/// Every object in the enclosure emits the share that it does not reflect, so the radiance is 1 in every direction.
/// Counting an emitter twice or not at all would change it. Light cannot be aimed at through glass: there, light found
/// by BSDF sampling must count in full.
pub(super) fn counted_once(trials: &mut Trials) {
    let enclosure = || object(&sphere([0.0; 3], 10.0), &diffuse(0.0), [1.0; 3]);
    let seen = |things: &[String]| scene(&[camera([0.0, 0.3, 5.0], [0.0; 3]), enclosure(), things.concat()]);
    let ball = |radius: f64| object(&sphere([0.0; 3], radius), &diffuse(0.8), [0.2; 3]);
    let mirror = object(&sphere([0.0; 3], 1.0), "{ mirror = { albedo = [0.7, 0.7, 0.7] } }", [0.3; 3]);
    let exact = |name, scene| Spot { name, scene, radiance: Some(1.0) };
    let spots = [
        exact("directly", seen(&[])),
        exact("in a mirror that glows", seen(&[mirror])),
        exact("on a matte ball", seen(&[ball(1.0)])),
        exact("through a ball of glass", seen(&[object(&sphere([0.0; 3], 1.0), GLASS, [0.0; 3])])),
        exact("on a matte ball inside glass", seen(&[object(&sphere([0.0; 3], 1.0), GLASS, [0.0; 3]), ball(0.5)])),
        Spot {
            name: "a lamp inside glass over a floor",
            scene: scene(&[
                "background = [0.0, 0.0, 0.0]\n".to_string(),
                camera([2.0, 1.5, 0.0], [0.0; 3]),
                object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]),
                object(&sphere([0.0, 1.0, 0.0], 0.6), GLASS, [0.0; 3]),
                object(&sphere([0.0, 1.0, 0.0], 0.3), &diffuse(0.0), [3.0; 3]),
            ]),
            radiance: None,
        },
    ];
    agree(trials, &spots, (64, 2048), 0.08);
}
