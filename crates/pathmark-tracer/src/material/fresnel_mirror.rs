//! A mirror that reflects the share given by Fresnel's formula and absorbs the rest: the "perfect mirror" of the second
//! report, whose renderer extends a course's exercise (GAMES101, 2020).
//!
//! ```toml
//! material = { fresnel-mirror = { eta = 12.85 } }
//! ```
//!
//! The report writes the delta lobe as F/cos with density 1 and returns 0 where cos < 0.001. That loses the light of
//! grazing directions and needs a clamp elsewhere. Here the lobe is a delta by type: its weight is F, without a
//! division by the cosine. The report's mirror does not use `Kd` and `Ks`, so there are no such fields.

use super::angular::schlick_average;
use super::{Bsdf, BsdfSample, Density};
use crate::input::refractive_index;
use crate::math::{Rgb, Vec3, fresnel_dielectric, reflect};
use serde::Deserialize;

/// A smooth surface over an opaque body that absorbs the light that enters it. Both sides are the same.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FresnelMirror {
    /// The body's index of refraction divided by the outside's.
    #[serde(deserialize_with = "refractive_index")]
    pub eta: f64,
}

impl FresnelMirror {
    #[inline(always)]
    fn reflected(&self, wo: Vec3) -> BsdfSample {
        BsdfSample { wi: reflect(wo), weight: Rgb::WHITE * fresnel_dielectric(wo.z, self.eta), density: Density::Delta }
    }
}

impl Bsdf for FresnelMirror {
    const EXAMPLES: &'static [&'static str] = &["{ fresnel-mirror = { eta = 12.85 } }"];

    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, _u: [f64; 2]) -> Option<BsdfSample> {
        Some(self.reflected(wo))
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        [Some(self.reflected(wo)), None]
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        Rgb::WHITE * schlick_average(fresnel_dielectric(1.0, self.eta))
    }

    fn albedo_at(&self, cos: f64) -> Option<Rgb> {
        Some(Rgb::WHITE * fresnel_dielectric(cos, self.eta))
    }
}
