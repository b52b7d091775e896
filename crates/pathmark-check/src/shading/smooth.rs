//! Smooth surfaces as delta mirrors: H23, H29.

use super::unguarded::mirror_of_report_b;
use crate::estimator::ESTIMATORS;
use crate::kernel::KERNELS;
use crate::material::Density;
use crate::materials::{every_material, towards};
use crate::math::{Rgb, Vec3, fresnel_dielectric};
use crate::refusals::{material, refused};
use crate::rendering::{Moments, difference, run, spec};
use crate::scene::AllEffects;
use crate::stage::{camera_above, diffuse, object, scene, sphere};
use crate::{Trials, critical};

fn conductor(alpha: &str) -> String {
    format!("{{ conductor = {{ alpha = {alpha}, f0 = [1.0, 0.75, 0.25] }} }}")
}

/// Roughness 0 gives a delta lobe and nothing to evaluate. Roughnesses between 0 and 1e-4 are refused. The images of
/// 1e-4 and of 0 agree.
pub(super) fn roughness_zero(trials: &mut Trials) {
    let gold = material(&conductor("0.0"));
    let wo = Vec3::new(0.6, 0.0, 0.8);
    let sample = gold.sample::<AllEffects>(wo, false, [0.3, 0.7]);
    trials.same(
        "direction, type",
        &Some((Vec3::new(-0.6, -0.0, 0.8), Density::Delta)),
        &sample.map(|s| (s.wi, s.density)),
    );
    // (1 - 0.8)^5 = 0.00032.
    let weights = sample.map_or([f64::NAN; 3], |sample| sample.weight.channels());
    for (channel, expected) in [1.0, 0.750_08, 0.250_24].into_iter().enumerate() {
        trials.close(format!("weight of channel {channel}"), expected, weights[channel], 1e-15);
    }
    for direction in [Vec3::new(-0.6, 0.0, 0.8), towards(0.5, 0.1)] {
        let asked = (gold.eval::<AllEffects>(wo, direction), gold.pdf::<AllEffects>(wo, direction));
        trials.same(format!("asked about {direction:?}"), &(Rgb::BLACK, 0.0), &asked);
    }
    let rough = material(&conductor("1e-4")).sample::<AllEffects>(wo, false, [0.3, 0.7]);
    let is_rough = rough.is_some_and(|sample| matches!(sample.density, Density::PerSolidAngle(_)));
    trials.holds("alpha 1e-4", "a density per steradian", format!("{rough:?}"), is_rough);
    for value in ["5e-5", "1e-6", "-0.1", "1.0000001", "nan", "inf"] {
        refused(trials, "{ conductor = { alpha = VALUE, f0 = [1.0, 1.0, 1.0] } }", "alpha", value, "0, or 1e-4 to 1");
        let layered = "{ kd-ks = { kd = [0.5, 0.5, 0.5], eta = 1.5, roughness = VALUE } }";
        refused(trials, layered, "roughness", value, "0, or 1e-4 to 1");
    }
    continuity(trials);
}

/// A ball that mirrors a lamp: a lobe that is too wide or has too large a weight would show. Next-event estimation
/// alone almost never finds the lobe of 1e-4, so only estimators that also follow sampled directions take part.
fn continuity(trials: &mut Trials) {
    let image = |alpha: &str| {
        scene(&[
            camera_above([0.0, 0.0, 4.0], [0.0; 3], 30.0),
            object(&sphere([0.0; 3], 1.0), &conductor(alpha), [0.0; 3]),
            object(&sphere([1.5, 2.5, 3.0], 0.5), &diffuse(0.0), [9.0; 3]),
            object(&sphere([0.0; 3], 10.0), &diffuse(0.5), [0.5; 3]),
        ])
    };
    let (rough, smooth) = (image("1e-4"), image("0.0"));
    let spp = trials.times(32, 512) as u32;
    let estimators = || ESTIMATORS.iter().map(|entry| entry.name).filter(|name| !["whitted", "nee"].contains(name));
    let limit = critical(KERNELS.len() * estimators().count());
    for kernel in KERNELS {
        for estimator in estimators() {
            let [rough, smooth] = [(&rough, 5), (&smooth, 6)].map(|(scene, seed)| {
                Moments::of(&run(scene, spec(estimator, kernel.name, [48; 2], seed), spp).film, 0)
            });
            let variant = format!("{}, {estimator}: image of 1e-4 and of 0", kernel.name);
            trials.at_most(format!("{variant}: relative error"), 0.01, smooth.error() / smooth.mean);
            trials.deviates_below(variant, limit, difference(&rough, &smooth));
        }
    }
}

/// The weight is F, also where the second report's guard makes it 0. No material of the table divides by a cosine.
pub(super) fn grazing(trials: &mut Trials) {
    let mirror = material("{ fresnel-mirror = { eta = 12.85 } }");
    for cos in [1.0, 0.5, 0.001, 9.9e-4, 5e-4, 1e-8, 1e-300, 0.0] {
        let expected = fresnel_dielectric(cos, 12.85);
        let sample = mirror.sample::<AllEffects>(towards(cos, 0.0), false, [0.5; 2]);
        let found = sample.map_or(f64::NAN, |sample| sample.weight.r);
        trials.close(format!("eta 12.85, cos {cos:?}"), expected, found, 0.0);
        let guarded = mirror_of_report_b(expected, cos);
        if cos < 0.001 {
            trials.at_least(format!("light that the report's guard loses at cos {cos:?}"), 0.9, expected - guarded);
        }
    }
    for (name, material) in every_material() {
        for cos in [1e-3, 1e-8, 1e-300, 5e-324, 0.0] {
            let wo = towards(cos, 0.3);
            let lobes = material.delta_lobes::<AllEffects>(wo, false);
            let light: f64 = lobes.iter().flatten().map(|lobe| lobe.weight.max_channel()).sum();
            let is_fine = (0.0..=1.0 + 1e-15).contains(&light);
            trials.holds(format!("{name}, cos {cos:?}: light of the delta lobes"), "0 to 1", light, is_fine);
        }
    }
}
