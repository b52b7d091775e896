//! A closed box in thermal equilibrium. Its walls emit the light that they do not reflect; a mirror ball and a glass
//! ball neither absorb nor emit. The radiance is therefore 1 everywhere, in every direction, for any albedo. A higher
//! albedo makes longer paths.

use super::Made;
use crate::material::{Dielectric, Diffuse, Fresnel, Material, Mirror};
use crate::math::{Rgb, Vec3};
use crate::scene::Sphere;
use crate::scene::shape::{AnyShape, Quad};
use serde::Deserialize;

/// The generator as scene files write it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Furnace {
    /// The albedo of the walls: the number behind the scene's name.
    pub(super) albedo: f64,
}

impl Furnace {
    pub(super) fn make(&self) -> Vec<Made> {
        let grey = |x: f64| Rgb { r: x, g: x, b: x };
        // The bits of k select -1 or 1 for each coordinate of corner k.
        let corner = |k: u8| {
            let side = |bit: u8| if k & bit == 0 { -1.0 } else { 1.0 };
            Vec3::new(side(1), side(2), side(4))
        };
        let walls = [
            ("left", [0, 4, 6, 2]),
            ("right", [1, 3, 7, 5]),
            ("floor", [0, 1, 5, 4]),
            ("ceiling", [2, 6, 7, 3]),
            ("back", [0, 2, 3, 1]),
            ("front", [4, 5, 7, 6]),
        ];
        let wall = |(name, corners): (&str, [u8; 4])| Made {
            name: name.to_string(),
            shapes: vec![AnyShape::Quad(Quad { corners: corners.map(corner) })],
            material: Material::Diffuse(Diffuse { albedo: grey(self.albedo) }),
            emission: grey(1.0 - self.albedo),
        };
        let ball = |name: &str, center: Vec3, material: Material| Made {
            name: name.to_string(),
            shapes: vec![AnyShape::Sphere(Sphere { center, radius: 0.35 })],
            material,
            emission: Rgb::BLACK,
        };
        let mirror = Material::Mirror(Mirror { albedo: Rgb::WHITE });
        let glass = Material::Dielectric(Dielectric { eta: 1.5, tint: Rgb::WHITE, fresnel: Fresnel::Schlick });
        let mut objects = vec![
            ball("mirror ball", Vec3::new(-0.4, -0.6, -0.4), mirror),
            ball("glass ball", Vec3::new(0.4, -0.6, 0.1), glass),
        ];
        objects.extend(walls.map(wall));
        objects
    }
}
