//! Sampling of visible microfacet normals: cosine-distributed directions seldom find the lobe.

use super::{Guard, InRender, Measured, Often, variant};
use crate::material::Ggx;
use crate::shading::unguarded::{Moments, albedo_by_cosines, albedo_by_visible_normals};

pub(super) const GUARD: Guard = Guard {
    name: "visible normals",
    error: "standard deviation of a sample of what GGX of α = 0.1 reflects of an even light, mean over ten angles",
    operation: "a sample",
    in_render: InRender { scene: "conductor-25", often: Often::BounceAtMost },
    with: variant!("visible normals", error, work, albedo_by_visible_normals),
    without: variant!("cosine", error, work, albedo_by_cosines),
};

type Estimate = fn(Ggx, f64, u64) -> Moments;

fn ggx() -> Ggx {
    Ggx::new(0.1).expect("from 1e-4 to 1")
}

fn error(estimate: Estimate) -> Measured {
    let deviation = |angle: u32| estimate(ggx(), 0.05 + 0.1 * f64::from(angle), 20_000).variance.sqrt();
    Measured::mean(&(0..10).map(deviation).collect::<Vec<f64>>())
}

fn work(count: u64, estimate: Estimate) -> f64 {
    estimate(ggx(), 0.5, count).mean
}
