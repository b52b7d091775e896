//! A polished surface: it mirrors part of the light, and the rest reaches a diffuse base. It is report C's
//! "reflectivity" of 80 percent.
//!
//! ```toml
//! material = { polished = { albedo = [0.75, 0.25, 0.25], reflectivity = 0.8 } }
//! ```
//!
//! The mirrored light keeps its colour, and its share does not depend on the angle. A real varnish follows Fresnel's
//! equations.

use super::{Bsdf, BsdfSample, Density};
use crate::input::{albedo, share};
use crate::math::{Rgb, Vec3, reflect};
use crate::sampling::cosine_hemisphere;
use serde::Deserialize;
use std::f64::consts::FRAC_1_PI;

/// A mirror over a matte base.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polished {
    /// The share that the base reflects of the light that reaches it, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub albedo: Rgb,
    /// The share of light that is mirrored, 0 to 1; the rest reaches the base.
    #[serde(deserialize_with = "share")]
    pub reflectivity: f64,
}

impl Polished {
    #[inline(always)]
    fn mirrored(wo: Vec3, share: f64) -> BsdfSample {
        BsdfSample { wi: reflect(wo), weight: Rgb::WHITE * share, density: Density::Delta }
    }

    /// The share of light that reaches the base.
    #[inline(always)]
    fn base(&self) -> f64 {
        1.0 - self.reflectivity
    }
}

impl Bsdf for Polished {
    const EXAMPLES: &'static [&'static str] = &[
        "{ polished = { albedo = [0.75, 0.5, 0.25], reflectivity = 0.0 } }",
        "{ polished = { albedo = [0.75, 0.5, 0.25], reflectivity = 0.3 } }",
        "{ polished = { albedo = [0.75, 0.5, 0.25], reflectivity = 0.8 } }",
    ];

    /// Mirrors with probability `reflectivity`. Otherwise the first random number is rescaled to sample the base.
    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, [u, v]: [f64; 2]) -> Option<BsdfSample> {
        if u < self.reflectivity {
            return Some(Self::mirrored(wo, 1.0));
        }
        let wi = cosine_hemisphere([(u - self.reflectivity) / self.base(), v]);
        Some(BsdfSample { wi, weight: self.albedo, density: Density::PerSolidAngle(self.base() * wi.z * FRAC_1_PI) })
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z * wi.z > 0.0 { self.albedo * (self.base() * FRAC_1_PI) } else { Rgb::BLACK }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if wo.z * wi.z > 0.0 { self.base() * wi.z.abs() * FRAC_1_PI } else { 0.0 }
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        [(self.reflectivity > 0.0).then(|| Self::mirrored(wo, self.reflectivity)), None]
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        self.albedo.map(|albedo| self.reflectivity + self.base() * albedo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polished(reflectivity: f64) -> Polished {
        Polished { albedo: Rgb { r: 0.75, g: 0.25, b: 0.0 }, reflectivity }
    }

    const WO: Vec3 = Vec3::new(0.6, 0.0, 0.8);

    /// For midpoints as the first random number, the share of mirrored samples is the reflectivity, the other samples
    /// cover the base's unit square evenly, and the mean weight is the albedo.
    #[test]
    fn lobes_have_their_shares() {
        for (reflectivity, mirrors) in [(0.0, 0), (0.25, 250), (0.8, 800), (1.0, 1000)] {
            let material = polished(reflectivity);
            let (mut found, mut weight, mut azimuth) = (0, Rgb::BLACK, Vec3::new(0.0, 0.0, 0.0));
            for k in 0..1000 {
                let sample = material.sample(WO, false, [(f64::from(k) + 0.5) / 1000.0, 0.3]).unwrap();
                weight += sample.weight * 1e-3;
                if sample.density == Density::Delta {
                    assert_eq!(sample.wi, Vec3::new(-0.6, -0.0, 0.8));
                    found += 1;
                } else {
                    azimuth = azimuth + sample.wi;
                    let pdf = material.pdf(WO, sample.wi);
                    assert_eq!(sample.density, Density::PerSolidAngle(pdf));
                    let value = material.eval(WO, sample.wi).r * sample.wi.z / pdf;
                    assert!((value - sample.weight.r).abs() < 1e-15, "weight {} is not {value}", sample.weight.r);
                }
            }
            assert_eq!(found, mirrors, "reflectivity {reflectivity}");
            assert!(azimuth.x.abs() < 1e-9 && azimuth.y.abs() < 1e-9, "lopsided: {azimuth:?}");
            for (mean, albedo) in weight.channels().into_iter().zip(material.albedo().channels()) {
                assert!((mean - albedo).abs() < 1e-12, "reflectivity {reflectivity}: {mean} instead of {albedo}");
            }
        }
        // 0.8 + 0.2 * 0.75, worked out by hand.
        assert!((polished(0.8).albedo().r - 0.95).abs() < 1e-15);
    }

    #[test]
    fn only_the_mirror_is_a_delta_lobe() {
        let [Some(lobe), None] = polished(0.8).delta_lobes(WO, false) else { panic!("one lobe") };
        assert_eq!((lobe.wi, lobe.weight, lobe.density), (reflect(WO), Rgb::WHITE * 0.8, Density::Delta));
        assert_eq!(polished(0.0).delta_lobes(WO, false), [None, None]);
        assert_eq!(polished(0.8).eval(WO, -WO), Rgb::BLACK);
    }
}
