//! The second report's guards and their effect on its material; the program's material creates no light: H24, H28.

use super::unguarded::reflection_of_report_b;
use crate::Trials;
use crate::material::{Bsdf, Conductor, Facets, GuardedKdKs, KdKs, Sampling};
use crate::materials::towards;
use crate::math::{Rgb, Vec3, fresnel_dielectric};
use crate::quadrature::integral;
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Albedo at normal incidence.
fn albedo(bsdf: &impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let wo = Vec3::new(0.0, 0.0, 1.0);
    // Rings are narrow near the normal: cos = 1 - x^4. The integrand is the same all around.
    let around = |x: f64, turns: f64| {
        let x2 = x * x;
        let cos = 1.0 - x2 * x2;
        bsdf(wo, towards(cos, turns)) * cos * TAU * 4.0 * x2 * x
    };
    (0..64).map(|k| integral([f64::from(k) / 64.0, f64::from(k + 1) / 64.0], [0.0, 1.0], 1e-7, &around)).sum()
}

/// Roughness, albedo with the guards, albedo without.
const TABLE: [(f64, f64, f64); 7] = [
    (0.0, 0.0561, 1.0),
    (0.01, 0.0612, 0.9999),
    (0.05, 0.1836, 0.9973),
    (0.1, 0.5693, 0.9883),
    (0.13, 0.9287, 0.9794),
    (0.14, 0.9757, 0.9757),
    (0.25, 0.9158, 0.9158),
];

/// The guard on D acts below α = 0.13357 and makes a smooth surface nearly black. A furnace that detects a loss of a
/// thousandth rejects every such roughness, and no other.
pub(super) fn guards(trials: &mut Trials) {
    for (roughness, with_guards, without) in TABLE {
        let found = albedo(&|wo, wi| reflection_of_report_b(roughness, wo, wi));
        trials.close(format!("roughness {roughness}: albedo with the guards"), with_guards, found, 6e-4);
        let metal = Conductor { facets: Facets::of(roughness), f0: Rgb::WHITE };
        let ours = metal.albedo_at(1.0).map_or(f64::NAN, |albedo| albedo.r);
        trials.close(format!("roughness {roughness}: our albedo"), without, ours, 6e-4);
        let is_rejected = (found - ours).abs() > 1e-3;
        trials.same(format!("roughness {roughness}: rejected"), &(roughness < 0.133_57), &is_rejected);
    }
    // Where no guard acts, the report's formulas equal the program's: the same material, written twice.
    for roughness in [0.25, 0.5, 1.0] {
        let kd = Rgb { r: 0.3, g: 0.3, b: 0.25 };
        let ours = KdKs { kd, eta: 12.85, facets: Facets::of(roughness), sampling: Sampling::Cosine };
        let mut worst: f64 = 0.0;
        for k in 0..10_000 {
            let towards = |of: i32| towards(0.05 + 0.95 * f64::from(k % of) / f64::from(of), f64::from(k % 61) / 61.0);
            let (wo, wi) = (towards(83), towards(71));
            let fresnel = fresnel_dielectric(wo.z, 12.85);
            let report = (1.0 - fresnel) * 0.3 * FRAC_1_PI + fresnel * reflection_of_report_b(roughness, wo, wi);
            worst = worst.max((ours.eval(wo, wi).r / report - 1.0).abs());
        }
        trials.at_most(format!("roughness {roughness}: off the report's formula where no guard acts"), 1e-9, worst);
    }
    // The material with the guards equals the report's formulas where they act, too: at grazing angles, and near the
    // normal for small roughness.
    for roughness in [0.0, 0.05, 0.25, 1.0] {
        let material = GuardedKdKs { kd: Rgb { r: 0.3, g: 0.3, b: 0.25 }, eta: 12.85, roughness };
        let (mut worst, mut guarded): (f64, u64) = (0.0, 0);
        for k in 0..10_000 {
            let towards = |of: i32| {
                towards(f64::from(k % of + 1) / f64::from(40 * of) * f64::from(k % 41), f64::from(k % 61) / 61.0)
            };
            let (wo, wi) = (towards(83), towards(71));
            if wo.z <= 0.0 || wi.z <= 0.0 {
                continue;
            }
            let fresnel = fresnel_dielectric(wo.z, 12.85);
            let is_guarded = 4.0 * wo.z * wi.z < 0.001;
            guarded += u64::from(is_guarded);
            let specular = if is_guarded { 1.0 } else { fresnel * reflection_of_report_b(roughness, wo, wi) };
            let report = (1.0 - fresnel) * 0.3 * FRAC_1_PI + specular;
            worst = worst.max((material.eval(wo, wi).r / report - 1.0).abs());
        }
        trials.at_most(format!("roughness {roughness}: off the report's guarded formula"), 1e-9, worst);
        trials.same(format!("roughness {roughness}: a guard acts"), &true, &(guarded > 100));
    }
}

/// The report's material at every roughness and angle. Its albedo comes from the material's quadrature and from a
/// plain quadrature of its BSDF.
pub(super) fn no_light_is_made(trials: &mut Trials) {
    let kd = Rgb { r: 0.3, g: 0.3, b: 0.25 };
    for roughness in [0.0, 0.05, 0.25, 0.5, 1.0] {
        for sampling in [Sampling::Cosine, Sampling::Vndf] {
            let material = KdKs { kd, eta: 12.85, facets: Facets::of(roughness), sampling };
            let at = |k: i32| material.albedo_at(f64::from(k) / 100.0).map_or(f64::NAN, Rgb::max_channel);
            let wrong = (1..=100).filter(|k| !(0.2..=1.0).contains(&at(*k))).count() as u64;
            trials.never(format!("roughness {roughness}, {sampling:?}"), "albedos outside of 0.2 to 1", wrong, 100);
            let mirrored = material.delta_lobes(Vec3::new(0.0, 0.0, 1.0), false)[0].map_or(0.0, |lobe| lobe.weight.r);
            let plain = albedo(&|wo, wi| material.eval(wo, wi).r) + mirrored;
            let variant = format!("roughness {roughness}, {sampling:?}: albedo at normal incidence");
            trials.close(variant, material.albedo_at(1.0).map_or(f64::NAN, |albedo| albedo.r), plain, 1e-3);
        }
    }
    // F + (1 - F) Kd for a mirror over the body, with F = (11.85/13.85)².
    let root = 11.85 / 13.85;
    let (fresnel, smooth) = (root * root, KdKs { kd, eta: 12.85, facets: Facets::of(0.0), sampling: Sampling::Cosine });
    let found = smooth.albedo_at(1.0).map_or(f64::NAN, |albedo| albedo.r);
    trials.close("smooth, normal incidence", fresnel + (1.0 - fresnel) * 0.3, found, 1e-15);
    trials.close(
        "and its value",
        (1.0 - fresnel) * 0.3 / PI,
        smooth.eval(towards(1.0, 0.0), towards(0.5, 0.0)).r,
        1e-15,
    );
}
