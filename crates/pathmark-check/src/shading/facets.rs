//! GGX distribution, masking and weights: H20, H21, H22.

use super::unguarded::{cancelling_density, cancelling_density_f32, density_f32, weight_by_normals};
use crate::double_double::two_product;
use crate::material::{Conductor, Density, Facets, Ggx, Material};
use crate::materials::towards;
use crate::math::{Rgb, Vec3, dot, sin_cos_turns};
use crate::quadrature::integral;
use crate::sampling::{mix, unit};
use crate::scene::AllEffects;
use crate::{Trials, U};
use std::f64::consts::{PI, TAU};

const ALPHAS: [f64; 10] = [1e-4, 3e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0];
fn ggx(alpha: f64) -> Ggx {
    Ggx::new(alpha).expect("a roughness that is allowed")
}

/// The weak white furnace (Heitz 2014): facets that reflect everything and cast no shadow lose no light. The integral
/// is 1 for every roughness and angle if D and G belong to the same distribution.
pub(super) fn weak_furnace(trials: &mut Trials) {
    for alpha in ALPHAS {
        let ggx = ggx(alpha);
        for cos in [1.0, 0.75, 0.5, 0.25, 0.1, 0.05] {
            let wo = towards(cos, 0.0);
            // The integral runs over normals instead of directions. The coordinate x makes all roughnesses look alike:
            // tan = alpha x/(1 - x).
            let over_normals = |x: f64, turns: f64| {
                let tan = alpha * x / (1.0 - x);
                let z = 1.0 / (1.0 + tan * tan).sqrt();
                let (s, c) = sin_cos_turns(turns);
                let h = Vec3::new(tan * z * c, tan * z * s, z);
                let solid_angle = tan * z * z * z * alpha / ((1.0 - x) * (1.0 - x)) * TAU;
                let turned = dot(wo, h);
                if turned <= 0.0 {
                    return 0.0;
                }
                let wi = h * (2.0 * turned) - wo;
                ggx.pdf(wo, wi) * 4.0 * turned * solid_angle
            };
            // The domain is split so that no narrow peak is missed. Both halves of the circle are equal.
            let part = |k: u32, of: f64| [f64::from(k) / 16.0 * of, f64::from(k + 1) / 16.0 * of];
            let tolerance = if trials.times(0, 1) == 0 { 1e-7 } else { 1e-9 };
            let half: f64 =
                (0..256).map(|k| integral(part(k / 16, 1.0), part(k % 16, 0.5), tolerance, &over_normals)).sum();
            trials.close(format!("alpha {alpha}, cos {cos}"), 1.0, 2.0 * half, 5e-5);
        }
    }
}

/// F G2/G1 lies in [0, 1]. Sampling all normals instead of the visible ones gives unbounded weights at grazing
/// directions.
pub(super) fn weights(trials: &mut Trials) {
    let last = 1.0 - U;
    let extremes = [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.5, last], [0.25, 0.0]];
    let n = trials.times(20_000, 1_000_000);
    for alpha in ALPHAS {
        let mirror = Material::Conductor(Conductor { facets: Facets::of(alpha), f0: Rgb::WHITE });
        let (mut wrong, mut tried, mut largest, mut unguarded) = (0, 0, 0.0_f64, 0.0_f64);
        for k in 0..n {
            let cos = unit(mix(3 * k));
            let u = extremes.get(k as usize).copied().unwrap_or([unit(mix(3 * k + 1)), unit(mix(3 * k + 2))]);
            for cos in [cos, cos * cos * cos * cos, 1e-8, 0.0, 1.0] {
                let wo = towards(cos, 0.37);
                unguarded = unguarded.max(if cos > 0.0 { weight_by_normals(ggx(alpha), wo, u) } else { 0.0 });
                let Some(found) = mirror.sample::<AllEffects>(wo, false, u) else { continue };
                tried += 1;
                largest = largest.max(found.weight.r);
                let is_density = matches!(found.density, Density::PerSolidAngle(d) if d > 0.0 && d.is_finite());
                wrong += u64::from(!is_density || !(0.0..=1.0 + f64::EPSILON).contains(&found.weight.r));
            }
        }
        trials.never(format!("alpha {alpha}"), "weights outside of 0 to 1 or densities without an end", wrong, tried);
        trials.at_most(format!("alpha {alpha}: largest weight"), 1.0 + f64::EPSILON, largest);
        if alpha >= 0.25 {
            trials.at_least(format!("alpha {alpha}: largest weight by all normals"), 10.0, unguarded);
        }
    }
}

/// D in the form α²/(π (x² + y² + α² z²)²), without an inner fraction.
fn exact(alpha: f64, h: Vec3) -> f64 {
    let alpha2 = two_product(alpha, alpha);
    let sum = two_product(h.x, h.x) + two_product(h.y, h.y) + alpha2 * two_product(h.z, h.z);
    alpha2.over(sum * sum * two_product(PI, 1.0))
}

/// G1 = 2z/(z + sqrt(z² + α²(x² + y²))).
fn exact_masking(alpha: f64, w: Vec3) -> f64 {
    let z = two_product(w.z, 1.0);
    let flat = two_product(w.x, w.x) + two_product(w.y, w.y);
    (z + z).over(z + (z * z + two_product(alpha, alpha) * flat).sqrt())
}

/// The results are right within 20 roundings. The usual form, with 1 + cos² (α² - 1), shows that the inputs are hard.
/// At h = n in single precision it is off by 43 % for α = 3e-4 and divides by 0 for 1e-4.
pub(super) fn densities(trials: &mut Trials) {
    let n = trials.times(20_000, 1_000_000);
    let mut cancelling: f64 = 0.0;
    for alpha in ALPHAS {
        let (mut density, mut masking): (f64, f64) = (0.0, 0.0);
        for k in 0..n {
            // From the centre of the lobe to beyond its edge, uniform in the logarithm; the last ones are grazing.
            let tan = if k == 0 { 0.0 } else { alpha * libm::exp2(40.0 * k as f64 / n as f64 - 20.0) };
            let (sin, cos) = sin_cos_turns((k % 97) as f64 / 97.0);
            let h = Vec3::new(tan * cos, tan * sin, 1.0).normalized();
            let right = exact(alpha, h);
            density = density.max((ggx(alpha).density(h) / right - 1.0).abs() / U);
            masking = masking.max((ggx(alpha).masking(h) / exact_masking(alpha, h) - 1.0).abs() / U);
            cancelling = cancelling.max((cancelling_density(alpha, h) / right - 1.0).abs() / U);
        }
        trials.at_most(format!("alpha {alpha}: D, roundings"), 20.0, density);
        trials.at_most(format!("alpha {alpha}: G1, roundings"), 20.0, masking);
    }
    trials.at_least("the usual form of D, roundings", 1e6, cancelling);
    for (alpha, usual, right) in [(1e-2, 3182.04, 3183.10), (1e-3, 3.100e5, 3.183e5), (3e-4, 2.016e6, 3.537e6)] {
        let found = f64::from(cancelling_density_f32(alpha, 1.0));
        trials.close(format!("alpha {alpha}: the usual form in f32 at h = n"), usual, found, 2e-3 * usual);
        let found = f64::from(density_f32(alpha, [0.0, 0.0, 1.0]));
        trials.close(format!("alpha {alpha}: by components in f32 at h = n"), right, found, 1e-3 * right);
    }
    trials.same("alpha 1e-4: the usual form in f32 at h = n", &f32::INFINITY, &cancelling_density_f32(1e-4, 1.0));
    let found = f64::from(density_f32(1e-4, [0.0, 0.0, 1.0]));
    trials.close("alpha 1e-4: by components in f32 at h = n", 3.183e7, found, 1e4);
    trials.close("alpha 1e-4: D at h = n", 1e8 / PI, ggx(1e-4).density(Vec3::new(0.0, 0.0, 1.0)), 1e-7);
}
