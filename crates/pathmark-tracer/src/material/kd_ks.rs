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
use super::{Bsdf, BsdfSample, Density, Facets, Ggx, RoughSample};
use crate::input::{albedo, refractive_index};
use crate::math::{Real, Rgb, Vec3, fresnel_dielectric, reflect};
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
    fn fresnel<T: Real>(&self, wo: Vec3<T>) -> T {
        fresnel_dielectric(wo.z, T::splat(self.eta))
    }

    /// Returns the probability of sampling the facets under [`Sampling::Vndf`].
    #[inline(always)]
    fn chance<T: Real>(&self, fresnel: T) -> T {
        let zero = T::splat(0.0);
        let matte = (T::splat(1.0) - fresnel) * T::splat(self.kd.max_channel());
        // Avoids 0/0: if nothing is reflected, the choice does not matter.
        T::select(zero.lt(fresnel), fresnel / (fresnel + matte), zero)
    }

    #[inline(always)]
    fn rough<T: Real>(&self, ggx: Ggx, fresnel: T, wo: Vec3<T>, wi: Vec3<T>) -> Rgb<T> {
        let facets = fresnel * ggx.reflection(wo, wi);
        Rgb::splat(self.kd) * ((T::splat(1.0) - fresnel) * T::splat(FRAC_1_PI)) + Rgb::splat(Rgb::WHITE) * facets
    }

    #[inline(always)]
    fn rough_pdf<T: Real>(&self, ggx: Ggx, fresnel: T, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let cosine = wi.z * T::splat(FRAC_1_PI);
        match self.sampling {
            Sampling::Cosine => cosine,
            Sampling::Vndf => {
                let chance = self.chance(fresnel);
                chance * ggx.pdf(wo, wi) + (T::splat(1.0) - chance) * cosine
            }
        }
    }

    /// Returns the sample with that direction.
    #[inline(always)]
    fn weighted<T: Real>(&self, ggx: Ggx, fresnel: T, wo: Vec3<T>, wi: Vec3<T>) -> RoughSample<T> {
        let density = self.rough_pdf(ggx, fresnel, wo, wi);
        RoughSample { wi, weight: self.rough(ggx, fresnel, wo, wi) * (wi.z / density), density }
    }

    /// Chooses the facets with probability `chance`; the random number is rescaled to [0, 1) for the chosen part.
    #[inline(always)]
    fn choose<T: Real>([u, v]: [T; 2], chance: T) -> (T::Mask, [T; 2]) {
        let is_chosen = u.lt(chance);
        let rest = T::select(is_chosen, u, u - chance);
        (is_chosen, [rest / T::select(is_chosen, chance, T::splat(1.0) - chance), v])
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
        if let Facets::Rough(ggx) = self.facets {
            // Branches in place of the selections of `sample_rough`, so that only what is needed is computed.
            let wi = match self.sampling {
                Sampling::Cosine => cosine_hemisphere(u),
                Sampling::Vndf => match Self::choose(u, self.chance(fresnel)) {
                    (true, u) => ggx.mirrored_at_facet(wo, u).1,
                    (false, u) => cosine_hemisphere(u),
                },
            };
            return if wi.z > 0.0 { self.weighted(ggx, fresnel, wo, wi).above() } else { None };
        }
        // Each lobe's probability is its share of the light, so the share cancels in the weight.
        let (is_mirrored, u) = Self::choose(u, fresnel);
        Some(if is_mirrored {
            BsdfSample { wi: reflect(wo), weight: Rgb::WHITE, density: Density::Delta }
        } else {
            let wi = cosine_hemisphere(u);
            BsdfSample { wi, weight: self.kd, density: Density::PerSolidAngle((1.0 - fresnel) * wi.z * FRAC_1_PI) }
        })
    }

    #[inline(always)]
    fn sample_rough<T: Real>(&self, wo: Vec3<T>, u: [T; 2]) -> Option<RoughSample<T>> {
        let Facets::Rough(ggx) = self.facets else { return None };
        let fresnel = self.fresnel(wo);
        let wi = match self.sampling {
            Sampling::Cosine => cosine_hemisphere(u),
            Sampling::Vndf => {
                let (is_facet, u) = Self::choose(u, self.chance(fresnel));
                Vec3::select(is_facet, ggx.mirrored_at_facet(wo, u).1, cosine_hemisphere(u))
            }
        };
        Some(self.weighted(ggx, fresnel, wo, wi))
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return Rgb::BLACK;
        }
        match self.eval_rough(wo, wi) {
            Some((value, _)) => value,
            None => self.kd * ((1.0 - self.fresnel(wo)) * FRAC_1_PI),
        }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if wo.z < 0.0 || wi.z <= 0.0 {
            return 0.0;
        }
        match self.eval_rough(wo, wi) {
            Some((_, density)) => density,
            None => (1.0 - self.fresnel(wo)) * wi.z * FRAC_1_PI,
        }
    }

    #[inline(always)]
    fn eval_rough<T: Real>(&self, wo: Vec3<T>, wi: Vec3<T>) -> Option<(Rgb<T>, T)> {
        let Facets::Rough(ggx) = self.facets else { return None };
        let (zero, fresnel) = (T::splat(0.0), self.fresnel(wo));
        let (value, density) = (self.rough(ggx, fresnel, wo, wi), self.rough_pdf(ggx, fresnel, wo, wi));
        let is_below = wi.z.le(zero);
        Some((
            Rgb::select(wo.z.le(zero) | is_below, Rgb::splat(Rgb::BLACK), value),
            T::select(wo.z.lt(zero) | is_below, zero, density),
        ))
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
