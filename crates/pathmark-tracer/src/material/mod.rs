//! Materials: how surfaces scatter light. Each effect has its own file; this file is their table.
//!
//! To add one: write its file with a type that implements [`Bsdf`] and `Deserialize`, and give it its `mod` and a line in `materials!` below.

mod angular;
mod conductor;
mod dielectric;
mod diffuse;
mod fresnel_mirror;
mod ggx;
mod guarded_kd_ks;
mod kd_ks;
mod mirror;
mod polished;

use crate::effect::{EffectSet, Effects, Entry};
use crate::math::{Real, Rgb, Vec3};
use serde::Deserialize;

pub use dielectric::Fresnel;
pub use ggx::{Facets, Ggx};
pub use kd_ks::Sampling;

/// The density of a sampled direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Density {
    /// Per steradian.
    PerSolidAngle(f64),
    /// One of finitely many directions: it has no density, in particular no infinite one.
    Delta,
}

/// A sampled direction of scattering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// The direction, away from the surface; z < 0 leads through the surface.
    pub wi: Vec3,
    /// BSDF times |cos| divided by the density: the factor for the throughput.
    pub weight: Rgb,
    pub density: Density,
}

/// Directions that a rough surface samples, for one vertex or several side by side. Where `wi.z` is not above 0, the
/// surface absorbs the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughSample<T = f64> {
    pub wi: Vec3<T>,
    pub weight: Rgb<T>,
    /// Per steradian.
    pub density: T,
}

impl RoughSample {
    /// Returns the sample; `None` if the surface absorbs the path.
    #[inline(always)]
    fn above(self) -> Option<BsdfSample> {
        let Self { wi, weight, density } = self;
        (wi.z > 0.0).then_some(BsdfSample { wi, weight, density: Density::PerSolidAngle(density) })
    }
}

/// Scattering at a point. Directions are unit vectors in the local frame (z is the shading normal on the side of `wo`)
/// and point away from the surface.
pub trait Bsdf {
    /// Instances as scene files write them, for every check of hard cases of materials. The checks replace `ROUGHNESS`
    /// by many values, smooth included.
    const EXAMPLES: &'static [&'static str];

    /// Whether exchanging `wo` and `wi` keeps its value (Helmholtz reciprocity).
    const IS_RECIPROCAL: bool = true;

    /// Samples a direction `wi` for light that leaves along `wo`. `inside` says that `wo` is on the inner side of the
    /// shape. `None` means absorption.
    fn sample(&self, wo: Vec3, inside: bool, u: [f64; 2]) -> Option<BsdfSample>;

    /// Samples like [`Bsdf::sample`], for vertices side by side. `None` unless the surface is rough: one by one, its
    /// samples may have different kinds of density.
    #[inline(always)]
    fn sample_rough<T: Real>(&self, _wo: Vec3<T>, _u: [T; 2]) -> Option<RoughSample<T>> {
        None
    }

    /// Returns [`Bsdf::eval`] and [`Bsdf::pdf`], for pairs of directions side by side; `None` unless the surface is
    /// rough.
    #[inline(always)]
    fn eval_rough<T: Real>(&self, _wo: Vec3<T>, _wi: Vec3<T>) -> Option<(Rgb<T>, T)> {
        None
    }

    /// Returns the BSDF's value per steradian for a pair of directions; black for delta lobes.
    #[inline(always)]
    fn eval(&self, _wo: Vec3, _wi: Vec3) -> Rgb {
        Rgb::BLACK
    }

    /// Returns the density per steradian with which [`Bsdf::sample`] chooses `wi`; 0 for delta lobes.
    #[inline(always)]
    fn pdf(&self, _wo: Vec3, _wi: Vec3) -> f64 {
        0.0
    }

    /// Returns the delta lobes, each weighted by its share of the light, for estimators that follow all of them.
    #[inline(always)]
    fn delta_lobes(&self, _wo: Vec3, _inside: bool) -> [Option<BsdfSample>; 2] {
        [None, None]
    }

    /// Whether light passes through, into a separate medium inside the shape.
    const TRANSMITS: bool = false;

    /// Returns the share of light that it scatters: smallpt's "colour". If the share depends on the angle, this is
    /// about its mean: Russian roulette uses it and is unbiased for any value above 0.
    fn albedo(&self) -> Rgb;

    /// Returns the share of light that it scatters towards directions with that cosine, from 0 to 1, on either side;
    /// `None` if the share is [`Bsdf::albedo`] at every angle.
    fn albedo_at(&self, _cos: f64) -> Option<Rgb> {
        None
    }
}

macro_rules! materials {
    ($($module:ident :: $Type:ident, $name:literal, $about:literal;)*) => {
        $(pub use $module::$Type;)*

        #[derive(Clone, Copy)]
        enum Index { $($Type),* }

        $(impl $Type {
            pub const EFFECT: Effects = Effects::material(Index::$Type as u32);
        })*

        /// The materials, in the order in which they are listed.
        pub const MATERIALS: &[Entry] = &[$(Entry { name: $name, about: $about, effect: $Type::EFFECT }),*];

        /// Any material. In a scene file: `material = { diffuse = { albedo = [0.75, 0.25, 0.25] } }`.
        #[derive(Debug, Clone, PartialEq, Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub enum Material {
            $(#[doc = $about] $Type($Type)),*
        }

        impl Material {
            /// [`Bsdf::EXAMPLES`] of all materials.
            pub fn examples() -> Vec<&'static str> {
                [$($Type::EXAMPLES),*].concat()
            }

            /// [`Bsdf::IS_RECIPROCAL`] of the material.
            pub const fn is_reciprocal(&self) -> bool {
                match self { $(Self::$Type(_) => $Type::IS_RECIPROCAL),* }
            }

            pub const fn effect(&self) -> Effects {
                match self { $(Self::$Type(_) => $Type::EFFECT),* }
            }

            /// [`Bsdf::albedo`] of the material.
            #[inline(always)]
            pub fn albedo<X: EffectSet>(&self) -> Rgb {
                match self {
                    $(Self::$Type(material) if X::EFFECTS.cover($Type::EFFECT) => material.albedo(),)*
                    _ => Rgb::BLACK,
                }
            }

            /// [`Bsdf::albedo_at`] of the material.
            pub fn albedo_at(&self, cos: f64) -> Option<Rgb> {
                match self { $(Self::$Type(material) => material.albedo_at(cos)),* }
            }

            /// [`Bsdf::sample`] for the effects in `X`; the caller must choose an `X` that covers the scene.
            #[inline(always)]
            pub fn sample<X: EffectSet>(&self, wo: Vec3, inside: bool, u: [f64; 2]) -> Option<BsdfSample> {
                match self {
                    $(Self::$Type(material) if X::EFFECTS.cover($Type::EFFECT) => material.sample(wo, inside, u),)*
                    _ => None,
                }
            }

            /// [`Bsdf::sample_rough`] of the material.
            #[inline(always)]
            pub fn sample_rough<T: Real>(&self, wo: Vec3<T>, u: [T; 2]) -> Option<RoughSample<T>> {
                match self { $(Self::$Type(material) => material.sample_rough(wo, u)),* }
            }

            /// [`Bsdf::eval_rough`] of the material.
            #[inline(always)]
            pub fn eval_rough<T: Real>(&self, wo: Vec3<T>, wi: Vec3<T>) -> Option<(Rgb<T>, T)> {
                match self { $(Self::$Type(material) => material.eval_rough(wo, wi)),* }
            }

            /// Whether [`Material::sample_rough`] and [`Material::eval_rough`] have results.
            #[inline]
            pub fn is_rough(&self) -> bool {
                // The compiler leaves out the sample itself.
                self.sample_rough::<f64>(Vec3::new(0.0, 0.0, 1.0), [0.5; 2]).is_some()
            }

            /// [`Bsdf::eval`] for the effects in `X`.
            #[inline(always)]
            pub fn eval<X: EffectSet>(&self, wo: Vec3, wi: Vec3) -> Rgb {
                match self {
                    $(Self::$Type(material) if X::EFFECTS.cover($Type::EFFECT) => material.eval(wo, wi),)*
                    _ => Rgb::BLACK,
                }
            }

            /// [`Bsdf::pdf`] for the effects in `X`.
            #[inline(always)]
            pub fn pdf<X: EffectSet>(&self, wo: Vec3, wi: Vec3) -> f64 {
                match self {
                    $(Self::$Type(material) if X::EFFECTS.cover($Type::EFFECT) => material.pdf(wo, wi),)*
                    _ => 0.0,
                }
            }

            /// [`Bsdf::delta_lobes`] for the effects in `X`.
            #[inline(always)]
            pub fn delta_lobes<X: EffectSet>(&self, wo: Vec3, inside: bool) -> [Option<BsdfSample>; 2] {
                match self {
                    $(Self::$Type(material) if X::EFFECTS.cover($Type::EFFECT) => material.delta_lobes(wo, inside),)*
                    _ => [None, None],
                }
            }

            /// [`Bsdf::TRANSMITS`] of the material.
            pub const fn transmits(&self) -> bool {
                match self { $(Self::$Type(_) => $Type::TRANSMITS),* }
            }
        }
    };
}

materials! {
    diffuse::Diffuse, "diffuse", "ideal diffuse (Lambertian) reflection";
    mirror::Mirror, "mirror", "ideal specular reflection";
    dielectric::Dielectric, "dielectric", "clear glass: refraction and reflection by Schlick's or the exact Fresnel term";
    polished::Polished, "polished", "a mirror over a diffuse base";
    fresnel_mirror::FresnelMirror, "fresnel-mirror", "a mirror that absorbs the light that Fresnel's formula transmits";
    conductor::Conductor, "conductor", "metal, smooth or rough (GGX), with Schlick's Fresnel term";
    kd_ks::KdKs, "kd-ks", "a diffuse base under GGX facets, weighted by Fresnel's formula for the macroscopic normal";
    guarded_kd_ks::GuardedKdKs, "guarded-kd-ks", "wrong on purpose: kd-ks with report B's guards, which cut peaks and make light at grazing angles";
}
