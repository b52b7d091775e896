//! The second report's microfacet material as its program computes it, with the guards of its text. Wrong on purpose:
//! [`KdKs`](super::KdKs) is the same material without them.
//!
//! ```toml
//! material = { guarded-kd-ks = { kd = [0.3, 0.3, 0.25], eta = 12.85, roughness = 0.25 } }
//! ```
//!
//! D is 1 where its divisor is below 0.001, which cuts the peak of smooth surfaces, and the whole reflection is 1 where
//! 4 cos cos is below 0.001, which makes light at grazing angles. The guard on G never acts: its divisor is at least 1.
//! Directions follow the cosine. Roughness 0 is no mirror: D is then 1 near the normal and 0 elsewhere.

use super::angular::schlick_average;
use super::{Bsdf, BsdfSample, Density};
use crate::input::{albedo, refractive_index, roughness};
use crate::math::{Rgb, Vec3, fresnel_dielectric};
use crate::sampling::cosine_hemisphere;
use serde::Deserialize;
use std::f64::consts::{FRAC_1_PI, PI};

/// The report replaces a quotient by 1 if its divisor is below this.
const LEAST_DIVISOR: f64 = 0.001;

/// Directions of the quadrature of [`Bsdf::albedo_at`], from the normal outwards and around half of the hemisphere.
const RINGS: u32 = 256;
const SPOKES: u32 = 128;

/// A matte body under facets with thresholds. Both sides are the same.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GuardedKdKs {
    /// The share that the body scatters of the light that reaches it, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub kd: Rgb,
    /// The facets' index of refraction divided by the outside's.
    #[serde(deserialize_with = "refractive_index")]
    pub eta: f64,
    /// The roughness, GGX's α: 0, or 1e-4 to 1.
    #[serde(deserialize_with = "roughness")]
    pub roughness: f64,
}

#[inline(always)]
fn guarded(dividend: f64, divisor: f64) -> f64 {
    if divisor < LEAST_DIVISOR { 1.0 } else { dividend / divisor }
}

impl GuardedKdKs {
    /// Smith's Λ of a direction, by the tangent of its angle.
    #[inline(always)]
    fn lambda(&self, w: Vec3) -> f64 {
        let tan2 = (1.0 - w.z * w.z).max(0.0) / (w.z * w.z);
        ((1.0 + self.roughness * self.roughness * tan2).sqrt() - 1.0) / 2.0
    }

    /// The report's D, in the form that cancels.
    #[inline(always)]
    fn density(&self, h: Vec3) -> f64 {
        let alpha2 = self.roughness * self.roughness;
        let base = 1.0 + h.z * h.z * (alpha2 - 1.0);
        guarded(alpha2, PI * base * base)
    }
}

impl Bsdf for GuardedKdKs {
    /// None: its light at grazing angles fails the checks of materials.
    const EXAMPLES: &'static [&'static str] = &[];
    const IS_RECIPROCAL: bool = false;

    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = cosine_hemisphere(u);
        let density = Density::PerSolidAngle(self.pdf(wo, wi));
        Some(BsdfSample { wi, weight: self.eval(wo, wi) * PI, density })
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let fresnel = fresnel_dielectric(wo.z, self.eta);
        let masking = guarded(1.0, 1.0 + self.lambda(wo) + self.lambda(wi));
        let facets = fresnel * masking * self.density((wo + wi).normalized());
        self.kd * (FRAC_1_PI * (1.0 - fresnel)) + Rgb::WHITE * guarded(facets, 4.0 * wo.z * wi.z)
    }

    #[inline(always)]
    fn pdf(&self, _wo: Vec3, wi: Vec3) -> f64 {
        wi.z.max(0.0) * FRAC_1_PI
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        let fresnel = schlick_average(fresnel_dielectric(1.0, self.eta));
        self.kd * (1.0 - fresnel) + Rgb::WHITE * fresnel
    }

    /// By the midpoint rule over directions that follow the cosine. It exceeds 1 at grazing angles.
    fn albedo_at(&self, cos: f64) -> Option<Rgb> {
        let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let mut sum = Rgb::BLACK;
        for ring in 0..RINGS {
            for spoke in 0..SPOKES {
                // Half of the turns: both halves of the hemisphere are the same.
                let turns = 0.5 * (f64::from(spoke) + 0.5) / f64::from(SPOKES);
                sum += self.eval(wo, cosine_hemisphere([turns, (f64::from(ring) + 0.5) / f64::from(RINGS)]));
            }
        }
        Some(sum * (PI / f64::from(RINGS * SPOKES)))
    }
}
