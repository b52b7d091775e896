//! Metal: microfacets after Cook and Torrance (1982) with GGX normals, height-correlated shadowing and Schlick's
//! Fresnel term. Light that hits another facet is lost, so a rough metal is darker than a smooth one (59 % at α = 1).
//!
//! ```toml
//! material = { conductor = { alpha = 0.25, f0 = [1.0, 0.77, 0.34] } }
//! ```
//!
//! α = 0 is the smooth mirror, a separate type and not a limit. Otherwise α is from 1e-4, a lobe of some 0.01 degrees,
//! to 1.

use super::angular::{scattered, schlick_average};
use super::ggx::facets;
use super::{Bsdf, BsdfSample, Density, Facets, Ggx, RoughSample};
use crate::input::albedo;
use crate::math::{Real, Rgb, Vec3, dot, fresnel_schlick, reflect};
use serde::Deserialize;

/// A metal surface, the same on both sides.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conductor {
    /// The roughness, GGX's α.
    #[serde(rename = "alpha", deserialize_with = "facets")]
    pub facets: Facets,
    /// The share of light that a facet reflects at normal incidence, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub f0: Rgb,
}

impl Conductor {
    #[inline(always)]
    fn fresnel<T: Real>(&self, cos: T) -> Rgb<T> {
        let Rgb { r, g, b } = Rgb::splat(self.f0);
        Rgb { r: fresnel_schlick(cos, r), g: fresnel_schlick(cos, g), b: fresnel_schlick(cos, b) }
    }

    #[inline(always)]
    fn reflected(&self, wo: Vec3) -> BsdfSample {
        BsdfSample { wi: reflect(wo), weight: self.fresnel(wo.z), density: Density::Delta }
    }

    /// Returns the sample with that facet and direction. As the facet is sampled among visible ones, the weight is F G2/G1,
    /// at most 1.
    #[inline(always)]
    fn weighted<T: Real>(&self, ggx: Ggx, wo: Vec3<T>, h: Vec3<T>, wi: Vec3<T>) -> RoughSample<T> {
        RoughSample { wi, weight: self.fresnel(dot(wo, h)) * ggx.unshadowed(wo, wi), density: ggx.pdf(wo, wi) }
    }

    #[inline(always)]
    fn rough<T: Real>(&self, ggx: Ggx, wo: Vec3<T>, wi: Vec3<T>) -> Rgb<T> {
        // The facet's cosine is computed from wo + wi, so exchanging the two directions gives the same bits.
        let sum = wo + wi;
        self.fresnel(T::splat(0.5) * dot(sum, sum).sqrt()) * ggx.reflection(wo, wi)
    }
}

impl Bsdf for Conductor {
    const EXAMPLES: &'static [&'static str] = &["{ conductor = { alpha = ROUGHNESS, f0 = [1.0, 0.77, 0.34] } }"];

    /// `None` if the mirrored direction is below the surface.
    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
        let Facets::Rough(ggx) = self.facets else { return Some(self.reflected(wo)) };
        let (h, wi) = ggx.mirrored_at_facet(wo, u);
        // The branch saves weight and density of what is absorbed.
        if wi.z > 0.0 { self.weighted(ggx, wo, h, wi).above() } else { None }
    }

    #[inline(always)]
    fn sample_rough<T: Real>(&self, wo: Vec3<T>, u: [T; 2]) -> Option<RoughSample<T>> {
        let Facets::Rough(ggx) = self.facets else { return None };
        let (h, wi) = ggx.mirrored_at_facet(wo, u);
        Some(self.weighted(ggx, wo, h, wi))
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.eval_rough(wo, wi).map_or(Rgb::BLACK, |(value, _)| value)
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        self.eval_rough(wo, wi).map_or(0.0, |(_, density)| density)
    }

    #[inline(always)]
    fn eval_rough<T: Real>(&self, wo: Vec3<T>, wi: Vec3<T>) -> Option<(Rgb<T>, T)> {
        let Facets::Rough(ggx) = self.facets else { return None };
        let zero = T::splat(0.0);
        Some((self.rough(ggx, wo, wi), T::select(zero.lt(wi.z), ggx.pdf(wo, wi), zero)))
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        [(self.facets == Facets::Mirror).then(|| self.reflected(wo)), None]
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        let Rgb { r, g, b } = self.f0;
        Rgb { r: schlick_average(r), g: schlick_average(g), b: schlick_average(b) }
    }

    fn albedo_at(&self, cos: f64) -> Option<Rgb> {
        Some(match self.facets {
            Facets::Mirror => self.fresnel(cos),
            Facets::Rough(ggx) => scattered(ggx, cos, |wo, wi| self.rough(ggx, wo, wi)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of α are refused, with the allowed range, if their lobe is too narrow, if they exceed 1, and if they are
    /// negative, NaN or infinite.
    #[test]
    fn roughness_is_checked() {
        let read = |alpha: &str| toml::from_str::<Conductor>(&format!("alpha = {alpha}\nf0 = [1.0, 1.0, 1.0]"));
        for alpha in ["-0.1", "5e-5", "1.0000001", "nan", "inf"] {
            let problem = read(alpha).unwrap_err().to_string();
            assert!(problem.contains("allowed: 0, or 1e-4 to 1"), "{alpha}: {problem}");
        }
        assert_eq!(read("0.0").unwrap().facets, Facets::Mirror);
        for alpha in [1e-4, 1.0] {
            assert_eq!(read(&format!("{alpha:?}")).unwrap().facets, Facets::Rough(Ggx::new(alpha).unwrap()));
        }
    }

    /// The mean of Schlick's polynomial over the hemisphere: its integral with 2 cos by the midpoint rule.
    #[test]
    fn the_average_is_the_average() {
        let n = 10_000;
        let cosines = (0..n).map(|k| (f64::from(k) + 0.5) / f64::from(n));
        let mean = cosines.map(|cos| 2.0 * cos * fresnel_schlick(cos, 0.3)).sum::<f64>() / f64::from(n);
        assert!((mean - schlick_average(0.3)).abs() < 1e-7, "{mean}");
    }
}
