//! Generators: scenes that are computed instead of written, for studies that need many sizes. A scene file names one:
//!
//! ```toml
//! [generator.spheres]
//! count = 1000
//! seed = 1
//! ```
//!
//! Wherever a scene is named, `NAME:NUMBER` replaces the generator's first field: `spheres:100000`.
//!
//! To add one: write its file with a type that implements `Deserialize` and has a method `make`, and give it a line in
//! `generators!` below, with the field that the number sets and the numbers that are allowed.

mod bumpy_ball;
mod clusters;
mod furnace;
mod imbalance;
mod spheres;

use super::shape::AnyShape;
use crate::material::Material;
use crate::math::Rgb;
use serde::Deserialize;

/// An object that a generator makes.
pub(super) struct Made {
    pub(super) name: String,
    pub(super) shapes: Vec<AnyShape>,
    pub(super) material: Material,
    pub(super) emission: Rgb,
}

/// The most balls and triangles; the numbers of primitives have room to spare.
const MOST: f64 = 1e7;

macro_rules! generators {
    ($(
        $module:ident :: $Type:ident, $name:literal, $about:literal,
        $field:ident: $Number:ident in $range:expr, $allowed:literal;
    )*) => {
        /// Name and description of the generators, in the order in which they are listed.
        pub const GENERATORS: &[(&str, &str)] = &[$(($name, $about)),*];

        /// Any generator. In a scene file: `[generator.spheres]`.
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(super) enum Generator {
            $($Type($module::$Type)),*
        }

        impl Generator {
            /// The field that the number behind the scene's name sets.
            pub(super) fn field(&self) -> &'static str {
                match self { $(Self::$Type(_) => stringify!($field)),* }
            }

            pub(super) fn number(&self) -> f64 {
                match self { $(Self::$Type(generator) => f64::from(generator.$field)),* }
            }

            /// Sets that field; the error states the allowed values.
            pub(super) fn set_number(&mut self, number: f64) -> Result<(), &'static str> {
                match self { $(Self::$Type(generator) => {
                    if !$range.contains(&number) || f64::from(number as $Number) != number {
                        return Err($allowed);
                    }
                    generator.$field = number as $Number;
                }),* }
                Ok(())
            }

            pub(super) fn make(&self) -> Vec<Made> {
                match self { $(Self::$Type(generator) => generator.make()),* }
            }
        }
    };
}

generators! {
    spheres::Spheres, "spheres", "N diffuse balls, uniformly random in a cube; they fill the same share of it for every N",
        count: u32 in (1.0..=MOST), "a whole number from 1 to 10000000";
    clusters::Clusters, "clusters", "N diffuse balls in dense clusters in an otherwise empty cube",
        count: u32 in (1.0..=MOST), "a whole number from 1 to 10000000";
    imbalance::Imbalance, "imbalance", "paths of N rays on average in a sixteenth of the image, and of one ray elsewhere",
        factor: f64 in (7.0..=1000.0), "a factor from 7 to 1000";
    bumpy_ball::BumpyBall, "bumpy-ball", "a ball with bumps: a mesh of N triangles or a few more",
        triangles: u32 in (8.0..=MOST), "a whole number from 8 to 10000000";
    furnace::Furnace, "furnace", "a closed box of albedo N in thermal equilibrium, with a mirror ball and a glass ball",
        albedo: f64 in (0.0..1.0), "an albedo from 0 to below 1";
}
