//! Ideal specular reflection.
//!
//! ```toml
//! material = { mirror = { albedo = [0.999, 0.999, 0.999] } }
//! ```

use super::{Bsdf, BsdfSample, Density};
use crate::input::albedo;
use crate::math::{Rgb, Vec3, reflect};
use serde::Deserialize;

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mirror {
    /// The share of light that it reflects, per channel, 0 to 1.
    #[serde(deserialize_with = "albedo")]
    pub albedo: Rgb,
}

impl Bsdf for Mirror {
    const EXAMPLES: &'static [&'static str] = &["{ mirror = { albedo = [0.75, 0.5, 0.25] } }"];

    #[inline(always)]
    fn sample(&self, wo: Vec3, _inside: bool, _u: [f64; 2]) -> Option<BsdfSample> {
        Some(BsdfSample { wi: reflect(wo), weight: self.albedo, density: Density::Delta })
    }

    #[inline(always)]
    fn delta_lobes(&self, wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        [Some(BsdfSample { wi: reflect(wo), weight: self.albedo, density: Density::Delta }), None]
    }

    #[inline(always)]
    fn albedo(&self) -> Rgb {
        self.albedo
    }
}
