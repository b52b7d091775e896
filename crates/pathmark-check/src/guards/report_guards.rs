//! Divisions without thresholds: the second report replaces each quotient whose divisor is below 0.001, which turns
//! its smooth metals black.

use super::{Guard, InRender, Measured, Often, variant};
use crate::material::Ggx;
use crate::math::Vec3;
use crate::shading::unguarded::reflection_of_report_b;
use std::f64::consts::{FRAC_PI_2, TAU};

pub(super) const GUARD: Guard = Guard {
    name: "no thresholds in GGX",
    error: "error of the share that metal of α = 0.05 reflects of light from ahead, exactly 0.9973",
    operation: "a value of the BRDF",
    in_render: InRender { scene: "conductor-25", often: Often::BounceAtMost },
    with: variant!("none", error, work, ours),
    without: variant!("report B's, below 0.001", error, work, theirs),
};

const ALPHA: f64 = 0.05;
/// E(1, 0.05), computed to 20 digits.
const EXACT: f64 = 0.997_295_868_488_647_4;
const UP: Vec3 = Vec3 { x: 0.0, y: 0.0, z: 1.0 };

fn ours(wo: Vec3, wi: Vec3) -> f64 {
    Ggx::new(ALPHA).expect("from 1e-4 to 1").reflection(wo, wi)
}

fn theirs(wo: Vec3, wi: Vec3) -> f64 {
    reflection_of_report_b(ALPHA, wo, wi)
}

fn at(theta: f64) -> Vec3 {
    Vec3::new(libm::sin(theta), 0.0, libm::cos(theta))
}

/// The midpoint rule over the angle from the normal. The substitution θ = π/2 s³ puts most points into the lobe.
fn error(brdf: fn(Vec3, Vec3) -> f64) -> Measured {
    const STEPS: u32 = 20_000;
    let slice = |k: u32| {
        let s = (f64::from(k) + 0.5) / f64::from(STEPS);
        let wi = at(FRAC_PI_2 * s * s * s);
        TAU * brdf(UP, wi) * wi.z * wi.x * FRAC_PI_2 * 3.0 * s * s / f64::from(STEPS)
    };
    Measured::mean(&[((0..STEPS).map(slice).sum::<f64>() - EXACT).abs()])
}

fn work(count: u64, brdf: impl Fn(Vec3, Vec3) -> f64) -> f64 {
    let directions: [Vec3; 64] = std::array::from_fn(|k| at(0.02 * k as f64));
    (0..count as usize).map(|k| brdf(directions[(k * 7) % 64], directions[k % 64])).sum()
}
