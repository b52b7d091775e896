//! Features: effects of a scene besides materials and primitives. To add one, give it a line in `features!` and let
//! `Scene::effects` report its use.

use crate::effect::{Effects, Entry};

macro_rules! features {
    ($($index:ident, $NAME:ident, $name:literal, $about:literal;)*) => {
        #[derive(Clone, Copy)]
        enum Index { $($index),* }

        $(#[doc = concat!("The bit of: ", $about, ".")]
        pub const $NAME: Effects = Effects::feature(Index::$index as u32);)*

        /// The features, in the order in which they are listed.
        pub const FEATURES: &[Entry] = &[$(Entry { name: $name, about: $about, effect: $NAME }),*];
    };
}

features! {
    Hierarchy, HIERARCHY, "hierarchy", "a bounding volume hierarchy over the primitives";
    Background, BACKGROUND, "background", "radiance of rays that hit nothing";
    PointLight, POINT_LIGHT, "point-light", "point lights with inverse-square falloff";
    Lens, LENS, "lens", "a thin lens";
    Fog, FOG, "fog", "a homogeneous medium that absorbs, scatters and emits";
    Compound, COMPOUND, "compound", "objects that are made of several primitives";
    AngularEmission, ANGULAR_EMISSION, "angular-emission", "emission that depends on the angle to the normal";
    Epsilon, EPSILON, "epsilon", "a minimum distance of hits";
    Reach, REACH, "reach", "point lights with a limited reach";
}
