//! Clear glass: reflection and refraction by their Fresnel shares, total internal reflection, and a tint that
//! multiplies both lobes.
//!
//! ```toml
//! material = { dielectric = { eta = 1.5, tint = [0.999, 0.999, 0.999] } }
//! material = { dielectric = { eta = 1.5, tint = [0.999, 0.999, 0.999], fresnel = "exact" } }
//! ```
//!
//! `fresnel = "schlick"` is the default, as in smallpt: a polynomial whose error for η = 1.5 is at most 0.0357 of the
//! light (at cosine 0.088 from outside, 0.7476 from inside). `"exact"` is Fresnel's formula for unpolarised light.
//!
//! Refraction does not scale radiance by η² (smallpt's convention). This is correct if camera and lights are in the
//! same medium.

use super::{Bsdf, BsdfSample, Density};
use crate::input::{albedo, refractive_index};
use crate::math::{Rgb, Vec3, fresnel_dielectric, fresnel_schlick, reflect, refract};
use serde::Deserialize;

/// The formula for the reflected share of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fresnel {
    /// Schlick's approximation (1994), as in smallpt.
    #[default]
    Schlick,
    /// Fresnel's formula.
    Exact,
}

/// A smooth surface between air and a clear medium inside the shape.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dielectric {
    /// The inside's index of refraction divided by the outside's.
    #[serde(deserialize_with = "refractive_index")]
    pub eta: f64,
    /// The share of light that each lobe keeps, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub tint: Rgb,
    /// The formula for the reflected share.
    #[serde(default)]
    pub fresnel: Fresnel,
}

/// The refracted direction and the reflected share of light; none exists under total internal reflection.
struct Interface {
    refracted: Vec3,
    reflectance: f64,
}

impl Dielectric {
    #[inline(always)]
    fn interface(&self, wo: Vec3, inside: bool) -> Option<Interface> {
        let eta = if inside { self.eta } else { 1.0 / self.eta };
        let (refracted, cos2) = refract(wo, eta);
        if cos2 < 0.0 {
            return None;
        }
        let reflectance = match self.fresnel {
            Fresnel::Schlick => {
                let root = (self.eta - 1.0) / (self.eta + 1.0);
                // Schlick's formula takes the cosine in the medium with the lower index of refraction.
                let cos = if eta < 1.0 { wo.z } else { -refracted.z };
                fresnel_schlick(cos, root * root)
            }
            Fresnel::Exact => fresnel_dielectric(wo.z, if inside { 1.0 / self.eta } else { self.eta }),
        };
        Some(Interface { refracted, reflectance })
    }

    #[inline(always)]
    fn delta(&self, wi: Vec3, share: f64) -> BsdfSample {
        BsdfSample { wi, weight: self.tint * share, density: Density::Delta }
    }
}

impl Bsdf for Dielectric {
    const EXAMPLES: &'static [&'static str] = &[
        "{ dielectric = { eta = 1.5, tint = [0.9, 0.8, 0.7], fresnel = 'schlick' } }",
        "{ dielectric = { eta = 1.5, tint = [0.9, 0.8, 0.7], fresnel = 'exact' } }",
    ];

    /// Reflects with probability 1/4 + R/2, as in smallpt, so that each lobe's weight is at most 4/3.
    #[inline(always)]
    fn sample(&self, wo: Vec3, inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
        let Some(Interface { refracted, reflectance }) = self.interface(wo, inside) else {
            return Some(self.delta(reflect(wo), 1.0));
        };
        let chance = 0.25 + 0.5 * reflectance;
        Some(if u[0] < chance {
            self.delta(reflect(wo), reflectance / chance)
        } else {
            self.delta(refracted, (1.0 - reflectance) / (1.0 - chance))
        })
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, inside: bool) -> [Option<BsdfSample>; 2] {
        match self.interface(wo, inside) {
            None => [Some(self.delta(reflect(wo), 1.0)), None],
            Some(Interface { refracted, reflectance }) => {
                [Some(self.delta(reflect(wo), reflectance)), Some(self.delta(refracted, 1.0 - reflectance))]
            }
        }
    }

    const TRANSMITS: bool = true;

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        self.tint
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn glass() -> Dielectric {
        Dielectric { eta: 1.5, tint: Rgb::WHITE, fresnel: Fresnel::Schlick }
    }

    fn towards(cos: f64) -> Vec3 {
        Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
    }

    /// The reflected lobe's weight is Schlick's polynomial, calculated by hand for n = 1.5.
    #[test]
    fn reflectance_by_angle() {
        for (inside, cos, expected) in [
            (false, 1.0, 0.04),
            (false, 0.5, 0.07),
            (false, 0.1, 0.606_870_4),
            (true, 0.9, 0.040_819_485_607_2),
            (true, 0.8, 0.094_839_139_6),
            (true, 0.75, 0.532_392_578_125),
        ] {
            let reflected = glass().delta_lobes(towards(cos), inside)[0].unwrap();
            assert!((reflected.weight.r - expected).abs() < 1e-9, "inside {inside} cos {cos}: {}", reflected.weight.r);
        }
        assert!(glass().delta_lobes(towards(0.7), true)[1].is_none(), "cos 0.7 is beyond the critical angle");
    }
}
