//! So many balls of the same size in the cube from -1 to 1, at random places; they may overlap. The radius shrinks with the cube root of
//! their number, so that they fill the same share of the cube and an image keeps its character.

use super::{Generate, Made};
use crate::material::{Diffuse, Material};
use crate::math::{Rgb, Vec3};
use crate::scene::Sphere;
use crate::scene::shape::AnyShape;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Deserialize;

/// The most that fit in the numbers of primitives with room to spare.
const MOST: f64 = 1e7;

/// Balls of one colour are one object.
const COLOURS: usize = 8;

/// The generator as it is written.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Spheres {
    /// How many: the number behind the scene's name.
    count: u32,
    /// Of their places and colours.
    seed: u64,
}

impl Generate for Spheres {
    const FIELD: &'static str = "count";

    fn number(&self) -> f64 {
        f64::from(self.count)
    }

    fn set_number(&mut self, number: f64) -> Result<(), &'static str> {
        if !(1.0..=MOST).contains(&number) || number.fract() != 0.0 {
            return Err("a whole number from 1 to 10000000");
        }
        self.count = number as u32;
        Ok(())
    }

    fn make(&self) -> Vec<Made> {
        let mut numbers = Pcg64::seed_from_u64(self.seed);
        let mut unit = || (numbers.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let radius = 0.5 / libm::cbrt(f64::from(self.count.max(1)));
        let mut made: Vec<Made> = (0..COLOURS)
            .map(|colour| {
                let mut albedo = || 0.2 + 0.6 * unit();
                let albedo = Rgb { r: albedo(), g: albedo(), b: albedo() };
                let (material, emission) = (Material::Diffuse(Diffuse { albedo }), Rgb::BLACK);
                Made { name: format!("balls of colour {colour}"), shapes: Vec::new(), material, emission }
            })
            .collect();
        for index in 0..self.count as usize {
            let mut coordinate = || 2.0 * unit() - 1.0;
            let center = Vec3::new(coordinate(), coordinate(), coordinate());
            made[index % COLOURS].shapes.push(AnyShape::Sphere(Sphere { center, radius }));
        }
        made
    }
}
