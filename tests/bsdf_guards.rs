//! H24, H29: what the second report's guards do to its materials. The report puts D, and the whole reflection, to 1 wherever a divisor is
//! below 0.001. Here they are put back, and the tests that hold our material would reject the result.

#[path = "support/quadrature.rs"]
mod quadrature;

use pathmark::material::{Bsdf, Conductor, Facets, KdKs, Sampling};
use pathmark::math::{Rgb, Vec3, fresnel_dielectric, sin_cos_turns};
use quadrature::integral;
use std::f64::consts::{PI, TAU};

const GUARD: f64 = 0.001;

/// The report's D G/(4 cos cos) with its guards, for facets that reflect everything.
fn guarded(roughness: f64, wo: Vec3, wi: Vec3) -> f64 {
    let roughness2 = roughness * roughness;
    let lambda = |w: Vec3| 0.5 * (1.0 + roughness2 * (1.0 - w.z * w.z) / (w.z * w.z)).sqrt() - 0.5;
    let g = 1.0 / (1.0 + lambda(wo) + lambda(wi));
    let h = (wo + wi).normalized();
    let base = 1.0 + h.z * h.z * (roughness2 - 1.0);
    let divisor = PI * base * base;
    let d = if divisor < GUARD { 1.0 } else { roughness2 / divisor };
    let divisor = 4.0 * wo.z * wi.z;
    if divisor < GUARD { 1.0 } else { g * d / divisor }
}

/// The share of light that comes back at normal incidence.
fn albedo(bsdf: &impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let wo = Vec3::new(0.0, 0.0, 1.0);
    // Rings are narrow about the normal: cos = 1 - x^4. Everything is the same all around.
    let around = |x: f64, turns: f64| {
        let x2 = x * x;
        let cos = 1.0 - x2 * x2;
        let rim = (1.0 - cos * cos).max(0.0).sqrt();
        let (s, c) = sin_cos_turns(turns);
        bsdf(wo, Vec3::new(rim * c, rim * s, cos)) * cos * TAU * 4.0 * x2 * x
    };
    (0..64).map(|k| integral([f64::from(k) / 64.0, f64::from(k + 1) / 64.0], [0.0, 1.0], 1e-7, &around)).sum()
}

/// Roughness, what the guards leave, what should come back.
const TABLE: [(f64, f64, f64); 7] = [
    (0.0, 0.0561, 1.0),
    (0.01, 0.0612, 0.9999),
    (0.05, 0.1836, 0.9973),
    (0.1, 0.5693, 0.9883),
    (0.13, 0.9287, 0.9794),
    (0.14, 0.9757, 0.9757),
    (0.25, 0.9158, 0.9158),
];

/// The report's roughness 0 reflects a twentieth of the light instead of all of it. The furnace sees any surface that gives back less than
/// 1 - emission by a thousandth, so it would reject every roughness below 0.1336.
#[test]
fn guards_make_smooth_surfaces_black() {
    for (roughness, with_guards, without) in TABLE {
        let found = albedo(&|wo, wi| guarded(roughness, wo, wi));
        assert!((found - with_guards).abs() < 6e-4, "roughness {roughness}: {found}, not {with_guards}");
        let metal = Conductor { facets: Facets::of(roughness), f0: Rgb::WHITE };
        let ours = metal.albedo_at(1.0).unwrap().r;
        assert!((ours - without).abs() < 6e-4, "roughness {roughness}: {ours}, not {without}");
        let is_rejected = (found - ours).abs() > 1e-3;
        assert_eq!(is_rejected, roughness < 0.133_57, "roughness {roughness}: {found} against {ours}");
    }
}

/// Where no guard acts the report's formulas are ours: the same material, written twice.
#[test]
fn without_guards_it_is_the_same_material() {
    for roughness in [0.25, 0.5, 1.0] {
        let kd = Rgb { r: 0.3, g: 0.3, b: 0.25 };
        let ours = KdKs { kd, eta: 12.85, facets: Facets::of(roughness), sampling: Sampling::Cosine };
        for k in 0..10_000 {
            let towards = |k: i32, of: i32| {
                let cos = 0.05 + 0.95 * f64::from(k % of) / f64::from(of);
                let (s, c) = sin_cos_turns(f64::from(k % 61) / 61.0);
                let rim = (1.0 - cos * cos).sqrt();
                Vec3::new(rim * c, rim * s, cos)
            };
            let (wo, wi) = (towards(k, 83), towards(k, 71));
            let fresnel = fresnel_dielectric(wo.z, 12.85);
            let report = (1.0 - fresnel) * 0.3 / PI + fresnel * guarded(roughness, wo, wi);
            let found = ours.eval(wo, wi).r;
            assert!((found / report - 1.0).abs() < 1e-9, "roughness {roughness}: {found}, not {report}");
        }
    }
}
