//! Load imbalance: work that is concentrated in a corner by a given factor.
//!
//! The camera is at the centre of a diffuse sphere; a black screen close in front of it covers the image except the
//! upper left sixteenth. On the screen, a path ends with its first ray. In the sphere, with Russian roulette after the
//! fifth vertex, a path takes 5 + 1/(1 - albedo) rays on average, which determines the albedo. The sphere emits the
//! light that it does not reflect, so the corner is white.

use super::Made;
use crate::material::{Diffuse, Material};
use crate::math::{Rgb, Vec3};
use crate::scene::Sphere;
use crate::scene::shape::{AnyShape, Quad};
use serde::Deserialize;

/// Rays of a path before Russian roulette starts.
const CERTAIN: f64 = 5.0;

/// The generator as scene files write it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Imbalance {
    /// Mean number of rays of a path in the corner (elsewhere one): the number behind the scene's name.
    pub(super) factor: f64,
}

impl Imbalance {
    pub(super) fn make(&self) -> Vec<Made> {
        let albedo = 1.0 - 1.0 / (self.factor - CERTAIN);
        let grey = |x: f64| Rgb { r: x, g: x, b: x };
        let diffuse = |albedo: f64| Material::Diffuse(Diffuse { albedo: grey(albedo) });
        let sphere = Made {
            name: "sphere".to_string(),
            shapes: vec![AnyShape::Sphere(Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: 1.0 })],
            material: diffuse(albedo),
            emission: grey(1.0 - albedo),
        };
        // The image plane is as high as it is far away, so at `z` the image reaches `half` up and a third further
        // sideways.
        let (z, half) = (-1e-4, 0.5e-4);
        let screen = |name: &str, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]| Made {
            name: name.to_string(),
            shapes: vec![AnyShape::Quad(Quad {
                corners: [Vec3::new(x0, y0, z), Vec3::new(x1, y0, z), Vec3::new(x1, y1, z), Vec3::new(x0, y1, z)],
            })],
            material: diffuse(0.0),
            emission: Rgb::BLACK,
        };
        let wide = 4.0 * half;
        let corner = -half * 2.0 / 3.0;
        vec![
            sphere,
            screen("screen below", [-wide, wide], [-wide, half / 2.0]),
            screen("screen beside", [corner, wide], [half / 2.0, wide]),
        ]
    }
}
