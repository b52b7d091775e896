//! Glass and other random choices between lobes: H13, H14.

use super::unguarded::schlick;
use crate::estimator::ESTIMATORS;
use crate::kernel::KERNELS;
use crate::material::{Dielectric, Fresnel, Material};
use crate::materials::{every_material, towards};
use crate::math::{Rgb, Vec3, fresnel_dielectric};
use crate::rendering::{Moments, run, spec};
use crate::scene::{AllEffects, load};
use crate::{Trials, critical};

/// smallpt's probability of reflection, 1/4 + R/2, lies between 1/4 and 3/4. So no weight exceeds 4/3, none is 0/0
/// under total reflection, and the mean weight is 1. Every other material with delta lobes also chooses them by their
/// share of light.
pub(super) fn weights(trials: &mut Trials) {
    let last = 1.0 - 0.5 * f64::EPSILON;
    for (fresnel, inside) in
        [Fresnel::Schlick, Fresnel::Exact].into_iter().flat_map(|kind| [(kind, false), (kind, true)])
    {
        let glass = Material::Dielectric(Dielectric { eta: 1.5, tint: Rgb::WHITE, fresnel });
        let (mut off_mean, mut off_share, mut largest, mut wrong, mut total) = (0.0_f64, 0.0_f64, 0.0_f64, 0, 0);
        let n = trials.times(1000, 1_000_000) as u32;
        for k in 0..=n {
            let wo = towards(f64::from(k) / f64::from(n), 0.2);
            let [low, high] = [0.0, last].map(|u| glass.sample::<AllEffects>(wo, inside, [u, 0.5]));
            let (Some(low), Some(high)) = (low, high) else {
                wrong += 1;
                continue;
            };
            largest = largest.max(low.weight.r).max(high.weight.r);
            match glass.delta_lobes::<AllEffects>(wo, inside) {
                [Some(reflected), Some(refracted)] => {
                    let share = reflected.weight.r;
                    let chance = 0.25 + 0.5 * share;
                    wrong +=
                        u32::from(!(0.25..=0.75).contains(&chance) || reflected.wi.z < 0.0 || refracted.wi.z > 0.0);
                    let weights = [share / chance - low.weight.r, refracted.weight.r / (1.0 - chance) - high.weight.r];
                    off_mean = weights.into_iter().map(f64::abs).fold(off_mean, f64::max);
                    off_mean = off_mean.max((chance * low.weight.r + (1.0 - chance) * high.weight.r - 1.0).abs());
                    off_mean = off_mean.max((share + refracted.weight.r - 1.0).abs());
                    let eta = if inside { 1.0 / 1.5 } else { 1.5 };
                    let right = match fresnel {
                        Fresnel::Schlick => schlick(wo.z, eta),
                        Fresnel::Exact => fresnel_dielectric(wo.z, eta),
                    };
                    // Near the critical angle a rounding of the cosine changes the share by more than a rounding.
                    off_share = off_share.max((share - right).abs());
                }
                lobes => {
                    total += 1;
                    wrong += u32::from(lobes != [Some(low), None] || (low.weight.r, high.weight.r) != (1.0, 1.0));
                }
            }
        }
        let name = format!("{fresnel:?}, {}", if inside { "from inside" } else { "from outside" });
        trials.at_most(format!("{name}: weights off R/P and (1 - R)/(1 - P), their mean off 1"), 1e-15, off_mean);
        trials.at_most(format!("{name}: reflected share off its formula"), 1e-9, off_share);
        trials.at_most(format!("{name}: largest weight"), 4.0 / 3.0 + 1e-15, largest);
        trials.never(
            &name,
            "lobes on the wrong side, chances outside of 1/4 to 3/4 or weights under total reflection",
            wrong.into(),
            n.into(),
        );
        // The critical cosine is 0.745, and cosines are uniform: this share of them is beyond it.
        let expected = if inside { 0.745_356 } else { 0.0 };
        trials.close(format!("{name}: share of total reflection"), expected, f64::from(total) / f64::from(n), 2e-3);
    }
    shares(trials);
}

/// Steps the first random number uniformly over [0, 1). The mean weight of the chosen lobes equals the sum of the
/// lobes' weights, for every material of the table.
fn shares(trials: &mut Trials) {
    let n = trials.times(4096, 1 << 20);
    for (name, material) in every_material() {
        for cos in [1.0, 0.7, 0.3, 0.02] {
            let wo = towards(cos, 0.6);
            let lobes = material.delta_lobes::<AllEffects>(wo, false);
            let expected: f64 = lobes.iter().flatten().map(|lobe| lobe.weight.g).sum();
            let mut found = 0.0;
            for k in 0..n {
                let u = [(k as f64 + 0.5) / n as f64, 0.5];
                let sample = material.sample::<AllEffects>(wo, false, u);
                let lobe = sample.filter(|sample| sample.density == crate::material::Density::Delta);
                found += lobe.map_or(0.0, |lobe| lobe.weight.g) / n as f64;
            }
            trials.close(format!("{name}, cos {cos}: light of the delta lobes"), expected, found, 4.0 / n as f64);
        }
    }
}

/// Radiance is not scaled by the index squared, as documented: in equilibrium a camera inside smallpt's glass ball
/// sees 1, not 2.25. This holds for every estimator that follows all light and for every kernel.
pub(super) fn inside_the_glass(trials: &mut Trials) {
    let mut scene = load("cornell").expect("a shipped scene").in_equilibrium();
    (scene.camera.position, scene.camera.advance) = (Vec3::new(73.0, 16.5, 78.0), 0.0);
    let estimators = || ESTIMATORS.iter().map(|entry| entry.name).filter(|name| *name != "whitted");
    let limit = critical(3 * KERNELS.len() * estimators().count());
    let spp = trials.times(16, 512) as u32;
    for kernel in KERNELS {
        for estimator in estimators() {
            let outcome = run(&scene, spec(estimator, kernel.name, [64, 48], 21), spp);
            let counts = outcome.counts;
            trials.same(
                format!("{}, {estimator}: escaped, truncated, invalid", kernel.name),
                &(0, 0, 0),
                &(counts.escaped, counts.truncated, counts.invalid),
            );
            for channel in 0..3 {
                let found = Moments::of(&outcome.film, channel);
                let variant = format!("{}, {estimator}, channel {channel}", kernel.name);
                trials.at_most(format!("{variant}: power, limit times error"), 0.25, limit * found.error());
                trials.deviates_below(
                    format!("{variant}: mean {:.4}, not 1", found.mean),
                    limit,
                    (found.mean - 1.0) / found.error(),
                );
            }
        }
    }
}
