//! Directions that are too long, opposite, grazing or below the surface: H25, H27.

use super::unguarded::squared_tangent_of_angle;
use crate::Trials;
use crate::material::{Density, Ggx};
use crate::materials::{every_material, towards};
use crate::math::{Vec3, dot};
use crate::sampling::{mix, uniform_sphere, unit};
use crate::scene::AllEffects;

/// Computed from the angle, the tangent of a normalised vector is NaN where z rounds above 1, saturates at grazing
/// directions, and loses its sign below the surface. Computed from components it has none of these errors.
pub(super) fn beyond(trials: &mut Trials) {
    let above = 1.0 + f64::EPSILON;
    let by_angle = squared_tangent_of_angle(above);
    trials.holds("by the angle, z = 1 + ulp", "NaN", by_angle, by_angle.is_nan());
    trials.holds("by the angle, z = 0", "finite", squared_tangent_of_angle(0.0), squared_tangent_of_angle(0.0) < 1e33);
    for alpha in [1e-4, 0.01, 0.25, 1.0] {
        let ggx = Ggx::new(alpha).expect("a roughness that is allowed");
        let straight = Vec3::new(0.0, 0.0, above);
        trials.close(format!("alpha {alpha}: G1 of z = 1 + ulp"), 1.0, ggx.masking(straight), 1e-15);
        let right = ggx.density(Vec3::new(0.0, 0.0, 1.0));
        trials.close(format!("alpha {alpha}: D of z = 1 + ulp"), right, ggx.density(straight), 2e-15 * right);
        trials.close(format!("alpha {alpha}: G1 along the surface"), 0.0, ggx.masking(Vec3::new(1.0, 0.0, 0.0)), 0.0);
        trials.close(format!("alpha {alpha}: G1 below"), 0.0, ggx.masking(Vec3::new(0.6, 0.0, -0.8)), 0.0);
        trials.close(format!("alpha {alpha}: D below"), 0.0, ggx.density(Vec3::new(0.6, 0.0, -0.8)), 0.0);
    }
    longer_than_one(trials);
    // No light passes through an opaque surface or comes from below it.
    let below =
        [Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.0, 0.0, -1.0), towards(1e-8, 0.2).cross(Vec3::new(0.0, 0.0, 1.0))];
    for (name, material) in every_material() {
        let (mut wrong, mut n) = (0, 0);
        for wo in [Vec3::new(0.0, 0.0, above), towards(1e-8, 0.0), towards(0.8, 0.5)] {
            for wi in below.into_iter().filter(|wi| wi.z < 0.0) {
                n += 1;
                let is_dark =
                    material.eval::<AllEffects>(wo, wi).is_black() && material.pdf::<AllEffects>(wo, wi) == 0.0;
                wrong += u64::from(!is_dark);
            }
        }
        trials.never(name, "light or density below the surface", wrong, n);
    }
}

/// A third of normalised vectors are longer than 1 in rounded arithmetic. They must work as well as other directions.
fn longer_than_one(trials: &mut Trials) {
    let n = trials.times(20_000, 1_000_000);
    let (mut longer, mut wrong) = (0_u32, 0);
    let materials = every_material();
    for k in 0..n {
        let wo = uniform_sphere([unit(mix(4 * k)), unit(mix(4 * k + 1))]).normalized();
        let wo = Vec3 { z: wo.z.abs(), ..wo };
        if dot(wo, wo) <= 1.0 {
            continue;
        }
        longer += 1;
        let (_, material) = &materials[k as usize % materials.len()];
        let sample = material.sample::<AllEffects>(wo, false, [unit(mix(4 * k + 2)), unit(mix(4 * k + 3))]);
        let is_fine = sample.is_none_or(|sample| {
            let has_density = !matches!(sample.density, Density::PerSolidAngle(d) if !(d > 0.0 && d.is_finite()));
            has_density && sample.weight.is_valid_radiance() && (dot(sample.wi, sample.wi) - 1.0).abs() < 1e-14
        });
        wrong += u64::from(!is_fine);
    }
    trials.at_least("share of normalised vectors that are longer than 1", 0.1, f64::from(longer) / n as f64);
    trials.never("every material", "samples that are not finite or not of length 1", wrong, longer.into());
}

/// The BSDF is finite or 0, and never NaN.
pub(super) fn opposite(trials: &mut Trials) {
    let above = Vec3::new(0.0, 0.0, 1.0);
    let (flat, steep, tiny) = (Vec3::new(1.0, 0.0, 0.0), towards(1e-8, 0.0), towards(1e-300, 0.7));
    let pairs = [
        (above, -above),
        (flat, -flat),
        (flat, flat),
        (steep, towards(1e-8, 0.5)),
        (steep, steep),
        (tiny, -tiny),
        (tiny, towards(1e-300, 0.2)),
        (tiny, above),
    ];
    for (name, material) in every_material() {
        let mut wrong = 0;
        for (wo, wi) in pairs {
            let (value, pdf) = (material.eval::<AllEffects>(wo, wi), material.pdf::<AllEffects>(wo, wi));
            wrong += u64::from(!value.is_valid_radiance() || !(0.0..f64::INFINITY).contains(&pdf));
            wrong += u64::from(wi == -wo && wi.z < 0.0 && !value.is_black());
        }
        trials.never(
            name,
            "values or densities that are not finite, or light from the opposite side",
            wrong,
            pairs.len() as u64,
        );
    }
}
