//! Exact Fresnel equations: Schlick's polynomial is off by up to 0.036.

use super::{Guard, InRender, Measured, Often, variant};
use crate::math::fresnel_dielectric;
use crate::shading::fresnel::oracle;
use crate::shading::unguarded::schlick;

pub(super) const GUARD: Guard = Guard {
    name: "exact Fresnel",
    error: "mean error of glass's reflectance over 202 angles from either side",
    operation: "a reflectance",
    in_render: InRender { scene: "cornell-mesh-mirror", often: Often::BounceAtMost },
    with: variant!("Fresnel", error, work, fresnel_dielectric),
    without: variant!("Schlick", error, work, schlick),
};

fn error(reflectance: fn(f64, f64) -> f64) -> Measured {
    let errors: Vec<f64> =
        oracle().into_iter().map(|(eta, cos, exact)| (reflectance(cos, eta) - exact).abs()).collect();
    Measured::mean(&errors)
}

fn work(count: u64, reflectance: impl Fn(f64, f64) -> f64) -> f64 {
    (0..count).map(|k| reflectance((k % 1024) as f64 / 1024.0, if k % 2 == 0 { 1.5 } else { 1.0 / 1.5 })).sum()
}
