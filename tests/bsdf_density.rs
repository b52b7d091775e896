//! What materials say about a direction agrees with how they chose it: `eval` and `pdf` with the sample's own weight and density, the integral
//! of `pdf` with 1, and H20, H21, H25 and H27 of the catalogue of hard cases.

#[path = "support/materials.rs"]
mod materials;
#[path = "support/quadrature.rs"]
mod quadrature;

use materials::every_material;
use pathmark::material::{Conductor, Density, Facets, Ggx, Material};
use pathmark::math::{Rgb, Vec3, dot, sin_cos_turns};
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};
use pathmark::scene::AllEffects;
use quadrature::integral;
use std::f64::consts::TAU;

const ALPHAS: [f64; 9] = [1e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 0.75, 1.0];

fn pair(seed: u64, sample: u32) -> [f64; 2] {
    let key = SampleKey { seed, pixel: 0, sample };
    Independent.pair(Address { key, bounce: 1, branch: 0, purpose: Purpose::Bsdf })
}

fn direction(cos: f64, turns: f64) -> Vec3 {
    let rim = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = sin_cos_turns(turns);
    Vec3::new(rim * c, rim * s, cos)
}

/// weight = eval cos / pdf, and the density is `pdf`: another estimator that asks about the same direction hears the same.
#[test]
fn samples_agree_with_eval_and_pdf() {
    for (name, material) in every_material() {
        for sample in 0..20_000 {
            let [cos, turns] = pair(1, sample);
            let wo = direction(cos.max(1e-3), turns);
            let Some(found) = material.sample::<AllEffects>(wo, false, pair(2, sample)) else { continue };
            assert!((dot(found.wi, found.wi) - 1.0).abs() < 1e-14, "{name}: length of {:?}", found.wi);
            let Density::PerSolidAngle(density) = found.density else { continue };
            let pdf = material.pdf::<AllEffects>(wo, found.wi);
            assert!((density / pdf - 1.0).abs() < 1e-9, "{name}, {wo:?}: density {density}, pdf {pdf}");
            // Smooth over matte: the density has the chance of the matte part in it, and so has its value.
            let weight = material.eval::<AllEffects>(wo, found.wi) * (found.wi.z / pdf);
            for (own, asked) in found.weight.channels().into_iter().zip(weight.channels()) {
                assert!((own - asked).abs() <= 1e-9 * own, "{name}, {wo:?}: weight {own}, from eval {asked}");
            }
        }
    }
}

/// H21: F G2/G1 is within [0, 1] (up to two roundings), also along the surface and with the extremes of the random numbers.
#[test]
fn weights_of_visible_normals_are_at_most_one() {
    let last = 1.0 - 0.5 * f64::EPSILON;
    for alpha in ALPHAS {
        let mirror = Material::Conductor(Conductor { facets: Facets::of(alpha), f0: Rgb::WHITE });
        for sample in 0..50_000 {
            let [cos, turns] = pair(3, sample);
            let u = match sample {
                0 => [0.0, 0.0],
                1 => [0.0, last],
                2 => [last, last],
                _ => pair(4, sample),
            };
            for cos in [cos, cos * cos * cos * cos, 1e-8, 0.0, 1.0] {
                if let Some(found) = mirror.sample::<AllEffects>(direction(cos, turns), false, u) {
                    let weight = found.weight.r;
                    assert!((0.0..=1.0 + f64::EPSILON).contains(&weight), "alpha {alpha}, cosine {cos}: {weight}");
                    let Density::PerSolidAngle(density) = found.density else { panic!("alpha {alpha} is no mirror") };
                    assert!(density > 0.0 && density.is_finite(), "alpha {alpha}, cosine {cos}: density {density}");
                }
            }
        }
    }
}

/// H20, the weak white furnace (Heitz 2014): facets that reflect everything and cast no shadow lose nothing. The integral of
/// G1 D/(4 cos) over the whole sphere is 1 for every roughness and angle: D and G1 belong to the same distribution.
#[test]
fn the_weak_furnace_is_white() {
    for alpha in ALPHAS {
        let ggx = Ggx::new(alpha).unwrap();
        for cos in [1.0, 0.75, 0.5, 0.25, 0.1, 0.05] {
            let wo = direction(cos, 0.0);
            // Over normals instead of directions, in coordinates in which every roughness looks alike: tan = alpha x/(1 - x).
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
            // In parts, so that no narrow peak is overlooked.
            let part = |k: u32| [f64::from(k) / 16.0, f64::from(k + 1) / 16.0];
            let whole: f64 = (0..256).map(|k| integral(part(k / 16), part(k % 16), 1e-8, &over_normals)).sum();
            assert!((whole - 1.0).abs() < 2e-5, "alpha {alpha}, cosine {cos}: {whole}");
        }
    }
}

/// H25, H27: opposite directions, directions along the surface or below it and vectors longer than 1 by a rounding have finite answers; below
/// the surface there is nothing.
#[test]
fn degenerate_directions() {
    let above = Vec3::new(0.0, 0.0, 1.0 + f64::EPSILON);
    let flat = Vec3::new(1.0, 0.0, 0.0);
    let steep = direction(1e-8, 0.0);
    let below = Vec3::new(0.6, 0.0, -0.8);
    for (name, material) in every_material() {
        for (wo, wi) in [(above, above), (flat, -flat), (flat, flat), (steep, direction(1e-8, 0.5)), (steep, steep)] {
            let (value, pdf) = (material.eval::<AllEffects>(wo, wi), material.pdf::<AllEffects>(wo, wi));
            assert!(value.is_valid_radiance(), "{name}, {wo:?} and {wi:?}: {value:?}");
            assert!((0.0..f64::INFINITY).contains(&pdf), "{name}, {wo:?} and {wi:?}: {pdf}");
        }
        for wo in [above, steep, direction(0.8, 0.5)] {
            assert!(material.eval::<AllEffects>(wo, below).is_black(), "{name}: light through an opaque surface");
            assert_eq!(material.pdf::<AllEffects>(wo, below), 0.0, "{name}");
        }
    }
}
