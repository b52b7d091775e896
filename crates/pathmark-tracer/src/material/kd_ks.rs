//! The second report's microfacet material: a matte body under GGX facets,
//! f = (1 - F) Kd/π + F G D/(4 cos cos), with D and G as in [`Ggx`].
//!
//! ```toml
//! material = { kd-ks = { kd = [0.3, 0.3, 0.25], eta = 12.85, roughness = 0.25 } }
//! material = { kd-ks = { kd = [0.3, 0.3, 0.25], eta = 12.85, roughness = 0.25, sampling = "vndf" } }
//! ```
//!
//! F is Fresnel's formula for the normal of the macroscopic surface and the angle of `wo`, where the path comes from. A
//! model that obeys Helmholtz reciprocity takes F at the facet, whose angle is the same from both sides. This model
//! changes its value when the directions are exchanged, because F(wo) is not F(wi). It creates no light, however: it
//! scatters (1 - F) Kd + F E, and E of the facets is at most 1.
//!
//! The report sets D and the whole reflection to 1 where a divisor is below 0.001, which makes a surface of roughness 0
//! nearly black (0.056 of the light instead of all). Here there are no such guards. The report sets `Ks` but never
//! reads it: F takes its place, so there is no such field. Roughness 0 is, by type, a mirror over the matte body.

use super::angular::{scattered, schlick_average};
use super::ggx::facets;
use super::{Bsdf, BsdfSample, Density, Facets, Ggx};
use crate::input::{albedo, refractive_index};
use crate::math::{Rgb, Vec3, fresnel_dielectric, reflect};
use crate::sampling::cosine_hemisphere;
use serde::Deserialize;
use std::f64::consts::FRAC_1_PI;

/// The sampling of directions on a rough surface. All variants have the same expectation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// By the cosine, as in the report.
    #[default]
    Cosine,
    /// By visible normals or by the cosine, with probabilities in proportion to the light that each part of the surface
    /// reflects.
    Vndf,
}

/// A matte body under facets. Both sides are the same.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KdKs {
    /// The share that the body scatters of the light that reaches it, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub kd: Rgb,
    /// The facets' index of refraction divided by the outside's.
    #[serde(deserialize_with = "refractive_index")]
    pub eta: f64,
    /// The roughness, GGX's α: 0, or 1e-4 to 1.
    #[serde(rename = "roughness", deserialize_with = "facets")]
    pub facets: Facets,
    /// The sampling of directions on a rough surface.
    #[serde(default)]
    pub sampling: Sampling,
}

impl KdKs {
    #[inline(always)]
    fn fresnel(&self, wo: Vec3) -> f64 {
        fresnel_dielectric(wo.z, self.eta)
    }

    /// Returns the probability of sampling the facets under [`Sampling::Vndf`].
    #[inline(always)]
    fn chance(&self, fresnel: f64) -> f64 {
        let matte = (1.0 - fresnel) * self.kd.max_channel();
        // Avoids 0/0: if nothing is reflected, the choice does not matter.
        if fresnel > 0.0 { fresnel / (fresnel + matte) } else { 0.0 }
    }

    #[inline(always)]
    fn rough(&self, ggx: Ggx, fresnel: f64, wo: Vec3, wi: Vec3) -> Rgb {
        let facets = fresnel * ggx.reflection(wo, wi);
        self.kd * ((1.0 - fresnel) * FRAC_1_PI) + Rgb::WHITE * facets
    }

    #[inline(always)]
    fn rough_pdf(&self, ggx: Ggx, fresnel: f64, wo: Vec3, wi: Vec3) -> f64 {
        let cosine = wi.z * FRAC_1_PI;
        match self.sampling {
            Sampling::Cosine => cosine,
            Sampling::Vndf => {
                let chance = self.chance(fresnel);
                chance * ggx.pdf(wo, wi) + (1.0 - chance) * cosine
            }
        }
    }

    /// Chooses the facets with probability `chance`; the random number is rescaled to [0, 1) for the chosen part.
    #[inline(always)]
    fn choose([u, v]: [f64; 2], chance: f64) -> (bool, [f64; 2]) {
        if u < chance { (true, [u / chance, v]) } else { (false, [(u - chance) / (1.0 - chance), v]) }
    }
}

impl Bsdf for KdKs {
    const EXAMPLES: &'static [&'static str] = &[
        "{ kd-ks = { kd = [0.3, 0.3, 0.25], eta = 1.5, roughness = ROUGHNESS, sampling = 'cosine' } }",
        "{ kd-ks = { kd = [0.3, 0.3, 0.25], eta = 1.5, roughness = ROUGHNESS, sampling = 'vndf' } }",
    ];
    const IS_RECIPROCAL: bool = false;

    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
        let fresnel = self.fresnel(wo);
        let Facets::Rough(ggx) = self.facets else {
            // Each lobe's probability is its share of the light, so the share cancels in the weight.
            let (is_mirrored, u) = Self::choose(u, fresnel);
            return Some(if is_mirrored {
                BsdfSample { wi: reflect(wo), weight: Rgb::WHITE, density: Density::Delta }
            } else {
                let wi = cosine_hemisphere(u);
                BsdfSample { wi, weight: self.kd, density: Density::PerSolidAngle((1.0 - fresnel) * wi.z * FRAC_1_PI) }
            });
        };
        let wi = match self.sampling {
            Sampling::Cosine => cosine_hemisphere(u),
            Sampling::Vndf => match Self::choose(u, self.chance(fresnel)) {
                (true, u) => Ggx::mirrored(wo, ggx.visible_normal(wo, u)),
                (false, u) => cosine_hemisphere(u),
            },
        };
        if wi.z <= 0.0 {
            return None;
        }
        let pdf = self.rough_pdf(ggx, fresnel, wo, wi);
        let weight = self.rough(ggx, fresnel, wo, wi) * (wi.z / pdf);
        Some(BsdfSample { wi, weight, density: Density::PerSolidAngle(pdf) })
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        let fresnel = self.fresnel(wo);
        match self.facets {
            Facets::Mirror => self.kd * ((1.0 - fresnel) * FRAC_1_PI),
            Facets::Rough(ggx) => self.rough(ggx, fresnel, wo, wi),
        }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if wo.z < 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        let fresnel = self.fresnel(wo);
        match self.facets {
            Facets::Mirror => (1.0 - fresnel) * wi.z * FRAC_1_PI,
            Facets::Rough(ggx) => self.rough_pdf(ggx, fresnel, wo, wi),
        }
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        let mirrored =
            || BsdfSample { wi: reflect(wo), weight: Rgb::WHITE * self.fresnel(wo), density: Density::Delta };
        [(self.facets == Facets::Mirror).then(mirrored), None]
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        let fresnel = schlick_average(fresnel_dielectric(1.0, self.eta));
        self.kd * (1.0 - fresnel) + Rgb::WHITE * fresnel
    }

    fn albedo_at(&self, cos: f64) -> Option<Rgb> {
        let fresnel = fresnel_dielectric(cos, self.eta);
        let facets = match self.facets {
            Facets::Mirror => Rgb::WHITE,
            Facets::Rough(ggx) => scattered(ggx, cos, |wo, wi| Rgb::WHITE * ggx.reflection(wo, wi)),
        };
        Some(self.kd * (1.0 - fresnel) + facets * fresnel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A smooth surface: the mirror is sampled with probability F, and the lobes have the shares F and (1 - F) Kd.
    #[test]
    fn roughness_zero_is_a_mirror_over_a_matte_body() {
        let kd = Rgb { r: 0.5, g: 0.25, b: 0.125 };
        let material = KdKs { kd, eta: 1.5, facets: Facets::of(0.0), sampling: Sampling::Cosine };
        let wo = Vec3::new(0.0, 0.0, 1.0);
        let mirrored = material.sample(wo, false, [0.039, 0.5]).unwrap();
        assert_eq!((mirrored.weight, mirrored.density), (Rgb::WHITE, Density::Delta));
        let matte = material.sample(wo, false, [0.041, 0.5]).unwrap();
        assert_eq!(matte.weight, kd);
        assert_eq!(matte.density, Density::PerSolidAngle(material.pdf(wo, matte.wi)));
        assert!((material.delta_lobes(wo, false)[0].unwrap().weight.r - 0.04).abs() < 1e-15);
    }
}
