//! Balls of equal size at random places in the cube from -1 to 1; they may overlap. Their radius decreases with the
//! cube root of their number, so that they fill the same share of the cube and the image keeps its character.

use super::Made;
use crate::material::{Diffuse, Material};
use crate::math::{Rgb, Vec3};
use crate::scene::Sphere;
use crate::scene::shape::AnyShape;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde::Deserialize;

/// Number of colours; all balls of one colour are one object.
const COLOURS: usize = 8;

/// The generator as scene files write it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct Spheres {
    /// The number of balls: the number behind the scene's name.
    pub(super) count: u32,
    /// The seed of their places and colours.
    seed: u64,
}

impl Spheres {
    pub(super) fn make(&self) -> Vec<Made> {
        let mut balls = Balls::new(self.seed, 0.5 / libm::cbrt(f64::from(self.count.max(1))));
        for _ in 0..self.count {
            let place = balls.place();
            balls.add(place);
        }
        balls.made
    }
}

/// Balls of one size, added one by one with the colours in turn.
pub(super) struct Balls {
    numbers: Pcg64,
    radius: f64,
    count: usize,
    pub(super) made: Vec<Made>,
}

impl Balls {
    pub(super) fn new(seed: u64, radius: f64) -> Self {
        let mut balls = Self { numbers: Pcg64::seed_from_u64(seed), radius, count: 0, made: Vec::new() };
        for colour in 0..COLOURS {
            let mut albedo = || 0.2 + 0.6 * balls.unit();
            let albedo = Rgb { r: albedo(), g: albedo(), b: albedo() };
            let (material, emission) = (Material::Diffuse(Diffuse { albedo }), Rgb::BLACK);
            balls.made.push(Made { name: format!("balls of colour {colour}"), shapes: Vec::new(), material, emission });
        }
        balls
    }

    fn unit(&mut self) -> f64 {
        (self.numbers.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a random place in the cube from -1 to 1.
    pub(super) fn place(&mut self) -> Vec3 {
        let mut coordinate = || 2.0 * self.unit() - 1.0;
        Vec3::new(coordinate(), coordinate(), coordinate())
    }

    pub(super) fn add(&mut self, center: Vec3) {
        let sphere = Sphere { center, radius: self.radius };
        self.made[self.count % COLOURS].shapes.push(AnyShape::Sphere(sphere));
        self.count += 1;
    }
}
