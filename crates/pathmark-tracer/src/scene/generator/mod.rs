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
//! To add one: write its file with a type that implements [`Generate`] and `Deserialize`, and give it a line in `generators!` below.

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

/// A generator of objects.
trait Generate {
    /// The field that the number behind the scene's name sets.
    const FIELD: &'static str;

    /// Returns the value of that field.
    fn number(&self) -> f64;

    /// Sets that field; the error states the allowed values.
    fn set_number(&mut self, number: f64) -> Result<(), &'static str>;

    /// Returns the objects.
    fn make(&self) -> Vec<Made>;
}

macro_rules! generators {
    ($($module:ident :: $Type:ident, $name:literal, $about:literal;)*) => {
        /// Name and description of the generators, in the order in which they are listed.
        pub const GENERATORS: &[(&str, &str)] = &[$(($name, $about)),*];

        /// Any generator. In a scene file: `[generator.spheres]`.
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(super) enum Generator {
            $($Type($module::$Type)),*
        }

        impl Generator {
            /// See [`Generate::FIELD`].
            pub(super) fn field(&self) -> &'static str {
                match self { $(Self::$Type(_) => $module::$Type::FIELD),* }
            }

            /// See [`Generate::number`].
            pub(super) fn number(&self) -> f64 {
                match self { $(Self::$Type(generator) => generator.number()),* }
            }

            /// See [`Generate::set_number`].
            pub(super) fn set_number(&mut self, number: f64) -> Result<(), &'static str> {
                match self { $(Self::$Type(generator) => generator.set_number(number)),* }
            }

            /// Returns the objects.
            pub(super) fn make(&self) -> Vec<Made> {
                match self { $(Self::$Type(generator) => generator.make()),* }
            }
        }
    };
}

generators! {
    spheres::Spheres, "spheres", "N diffuse balls, uniformly random in a cube; they fill the same share of it for every N";
    clusters::Clusters, "clusters", "N diffuse balls in dense clusters in an otherwise empty cube";
    imbalance::Imbalance, "imbalance", "paths of N rays on average in a sixteenth of the image, and of one ray elsewhere";
    bumpy_ball::BumpyBall, "bumpy-ball", "a ball with bumps: a mesh of N triangles or a few more";
    furnace::Furnace, "furnace", "a closed box of albedo N in thermal equilibrium, with a mirror ball and a glass ball";
}
