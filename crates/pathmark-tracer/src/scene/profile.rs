//! Features, which are effects of a scene besides materials and primitives; and effect profiles: the sets of effects that
//! kernels are compiled for.
//!
//! A scene runs on the smallest profile that covers its effects, so an unused effect costs nothing. `--effects PROFILE`
//! forces a larger profile, to measure that cost. To add a feature, give it a line in `features!` and let
//! `Scene::effects` report its use.

use super::shape::{PRIMITIVES, Plane, Sphere};
use crate::effect::{EffectSet, Effects, Entry, all};
use crate::material::{Dielectric, Diffuse, MATERIALS, Mirror, Polished};

/// A function over profiles: it turns a profile's name into a type parameter of a kernel.
pub trait ProfileVisitor {
    type Output;
    /// Runs with the profile that was named.
    fn visit<X: EffectSet>(self) -> Self::Output;
}

/// One line of the table of profiles.
pub struct ProfileEntry {
    /// Its name on the command line and in records.
    pub name: &'static str,
    pub about: &'static str,
    pub effects: Effects,
}

macro_rules! profiles {
    ($($Type:ident, $name:literal, $about:literal, $effects:expr;)*) => {
        $(#[doc = $about] #[derive(Debug, Clone, Copy)] pub struct $Type;
        impl EffectSet for $Type { const EFFECTS: Effects = $effects; }
        impl $Type {
            /// Its name on the command line and in records.
            pub const NAME: &str = $name;
        })*

        /// The profiles. A scene gets the first one that covers it, so smaller ones come first.
        pub const PROFILES: &[ProfileEntry] =
            &[$(ProfileEntry { name: $name, about: $about, effects: $Type::EFFECTS }),*];

        /// Calls the visitor with the profile of that name; `None` if there is none.
        pub fn with_profile<V: ProfileVisitor>(name: &str, visitor: V) -> Option<V::Output> {
            match name {
                $($name => Some(visitor.visit::<$Type>()),)*
                _ => None,
            }
        }
    };
}

const SMALLPT: Effects = Sphere::EFFECT.and(Diffuse::EFFECT).and(Mirror::EFFECT).and(Dielectric::EFFECT);
const ALL: Effects = all(PRIMITIVES).and(all(MATERIALS)).and(all(FEATURES));

profiles! {
    DiffuseOnly, "diffuse", "only diffuse spheres", Sphere::EFFECT.and(Diffuse::EFFECT);
    SmallptEffects, "smallpt", "spheres that are diffuse, mirrors or glass", SMALLPT;
    LensEffects, "lens", "smallpt's effects through a lens", SMALLPT.and(LENS);
    FogEffects, "fog", "smallpt's effects in fog", SMALLPT.and(FOG);
    SceneryEffects, "scenery", "spheres and planes, polished or of smallpt's materials, under point lights or a sky, in a hierarchy",
        SMALLPT.and(Polished::EFFECT).and(Plane::EFFECT).and(BACKGROUND).and(POINT_LIGHT).and(HIERARCHY).and(COMPOUND);
    SurfaceEffects, "surfaces", "spheres, planes and triangles of every material, in a hierarchy",
        all(PRIMITIVES).and(all(MATERIALS)).and(HIERARCHY).and(COMPOUND);
    AllEffects, "all", "every effect", ALL;
}

/// The names of the effects, joined with `+`.
pub fn effect_names(effects: Effects) -> String {
    let tables = PRIMITIVES.iter().chain(MATERIALS).chain(FEATURES);
    let names: Vec<&str> = tables.filter(|entry| effects.cover(entry.effect)).map(|entry| entry.name).collect();
    names.join("+")
}

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
    Faults, FAULTS, "faults", "wrong on purpose: tests of spheres and planes as reports B and C have them";
}
