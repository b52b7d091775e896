//! Ideal diffuse reflection (Lambert, 1760): the same radiance in all directions.
//!
//! ```toml
//! material = { diffuse = { albedo = [0.75, 0.25, 0.25] } }
//! ```

use super::{Bsdf, BsdfSample, Density};
use crate::input::albedo;
use crate::math::{Rgb, Vec3};
use crate::sampling::cosine_hemisphere;
use serde::Deserialize;
use std::f64::consts::FRAC_1_PI;

/// A matte surface.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Diffuse {
    /// The share of light that it reflects, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub albedo: Rgb,
}

impl Bsdf for Diffuse {
    const EXAMPLES: &'static [&'static str] = &["{ diffuse = { albedo = [0.75, 0.5, 0.25] } }"];

    #[inline(always)]
    fn sample(&self, _wo: Vec3, _inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = cosine_hemisphere(u);
        // The weight is albedo/π · cos θ divided by cos θ/π.
        Some(BsdfSample { wi, weight: self.albedo, density: Density::PerSolidAngle(wi.z * FRAC_1_PI) })
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        if wo.z * wi.z > 0.0 { self.albedo * FRAC_1_PI } else { Rgb::BLACK }
    }

    fn pdf(&self, wo: Vec3, wi: Vec3) -> f64 {
        if wo.z * wi.z > 0.0 { wi.z.abs() * FRAC_1_PI } else { 0.0 }
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        self.albedo
    }
}
