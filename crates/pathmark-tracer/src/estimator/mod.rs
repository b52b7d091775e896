//! Estimators of the radiance along a camera ray: one file for each, and their table in this file.
//!
//! A new estimator needs a file with a type that implements [`Estimator`] and a function that makes it from
//! [`Options`], and a line in `estimators!` below.

mod bsdf;
mod camera_ray;
mod direct;
mod medium;
mod nee;
mod path;
mod roulette;
mod smallpt;
mod whitted;

use crate::effect::{EffectSet, Effects};
use crate::math::{Ray, Rgb};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{AllEffects, Hit, Scene, Tests};

pub use bsdf::Bsdf;
pub use camera_ray::{camera_ray, camera_share, extra_camera_rays};
pub use direct::HIDING;
pub use nee::{LightSampling, power_heuristic};
pub use path::{MAX_BOUNCES, Nee, Path};
pub use roulette::By;
pub use roulette::Roulette;
pub use smallpt::Smallpt;
pub use whitted::Whitted;

/// Declares the trait, and its implementation behind a pointer: a mere observer needs no kernel compiled for it.
macro_rules! probe {
    ($($(#[$about:meta])* $event:ident($($argument:ident: $Type:ty),*);)*) => {
        /// An observer of the events of paths. The empty implementation `()` costs nothing.
        pub trait Probe {
            $($(#[$about])* fn $event(&mut self, $(_: $Type),*) {})*
        }

        impl Probe for () {}

        impl Probe for &mut dyn Probe {
            $(fn $event(&mut self, $($argument: $Type),*) {
                (**self).$event($($argument),*);
            })*
        }
    };
}

probe! {
    /// A ray was traced, with these tests in the hierarchy, if there is one.
    ray(tests: Tests);
    /// A ray hit nothing: in a closed scene, a leak.
    escaped();
    /// A path was cut at the bounce limit.
    truncated();
    /// A vertex of the path: a ray with this throughput hit a surface after this many bounces.
    vertex(bounces: u16, ray: &Ray, hit: &Hit, throughput: Rgb);
    /// Light that a vertex after this many bounces adds to the sample.
    light(bounces: u16, contribution: Rgb);
    /// Fog scattered the path at this distance from `ray.origin`, where it has this throughput.
    scattered(bounces: u16, ray: &Ray, distance: f64, throughput: Rgb);
    /// The path splits: its other part is followed when this one has ended.
    split(bounces: u16);
    /// Russian roulette ended a part.
    roulette();
    /// A part of a path ended after this many bounces.
    ended(bounces: u16);
    /// The code of an effect ran.
    used(effect: Effects);
}

/// The rules in which the path-following estimators differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathRules {
    /// Number of first vertices at which a path follows both reflection and transmission; at most 2.
    pub splits: u16,
    /// The sampling of lights; `None` without next-event estimation.
    pub nee: Option<LightSampling>,
    /// The bounce limit of a path.
    pub max_depth: u16,
    /// When and with which probability Russian roulette ends paths.
    pub roulette: Roulette,
    /// Camera rays per sample; the light that they see is averaged.
    pub camera_rays: u16,
}

/// The effect profiles that an estimator's scalar kernels are compiled for. Each is a copy of the whole path, and takes seconds to compile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compiled {
    /// Only the profile with all effects.
    WithAllEffects,
    /// Also the profile with smallpt's effects.
    Common,
    /// Every profile, so that the cost of an effect can be measured, with the sampler `independent`.
    EveryProfile,
}

/// An estimator of radiance, one sample at a time: unbiased unless it has its own [`Estimator::MAX_DEPTH`].
pub trait Estimator: Send + Sync {
    /// A description, in one line of `pathmark list estimators`.
    const ABOUT: &'static str = "an estimator from outside";

    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;

    /// Whether it uses next-event estimation, for which the scene must have been given its lights.
    const AIMS: bool = false;

    /// The default bounce limit; `None` if only the throughput ends a path.
    const MAX_DEPTH: Option<u16> = None;

    /// The default rule of Russian roulette; `None` if it has none.
    const ROULETTE: Option<Roulette> = None;

    /// Whether a sample is a single path.
    const IS_ONE_PATH: bool = false;

    /// The largest bounce limit that a caller can request.
    const LARGEST_DEPTH: u16 = u16::MAX;

    /// Whether it scales the light at the end of a camera ray by [`camera_share`] if a sample has several camera rays.
    const SHARES_CAMERA_RAYS: bool = false;

    /// The effect profiles that its scalar kernels are compiled for.
    const COMPILED: Compiled = Compiled::WithAllEffects;

    /// The rules of its paths, for kernels that follow many paths at once; `None` if it does not follow such paths.
    fn rules(&self) -> Option<PathRules> {
        None
    }

    /// The radiance along `ray` in W sr⁻¹ m⁻² per channel, as estimated by sample `key`. If a sample has several camera
    /// rays, light at the end of this one is scaled by [`camera_share`], and [`extra_camera_rays`] adds the rest.
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb;
}

/// A type-erased estimator, compiled with every effect, for callers that examine single samples and need no speed. One
/// instance serves every sampler and probe. An effect that a scene does not use changes no bit.
pub trait AnyEstimator: Send + Sync {
    /// [`Estimator::rules`].
    fn any_rules(&self) -> Option<PathRules>;

    /// [`Estimator::sample`].
    fn estimate(&self, scene: &Scene, ray: Ray, key: SampleKey, sampler: &dyn Sampler, probe: &mut dyn Probe) -> Rgb;
}

impl<E: Estimator> AnyEstimator for E {
    fn any_rules(&self) -> Option<PathRules> {
        self.rules()
    }

    fn estimate(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &dyn Sampler,
        mut probe: &mut dyn Probe,
    ) -> Rgb {
        self.sample::<&dyn Sampler, AllEffects, &mut dyn Probe>(scene, ray, key, &sampler, &mut probe)
    }
}

/// A function that is generic over estimators. Through it a name on the command line becomes a type in a kernel.
pub trait EstimatorVisitor {
    type Output;
    /// Called with the named estimator.
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output;
}

/// One line of the table of estimators: a name, and the constants of [`Estimator`].
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    pub spp_multiple: u32,
    pub max_depth: Option<u16>,
    pub aims: bool,
    pub roulette: Option<Roulette>,
    pub is_one_path: bool,
    pub largest_depth: u16,
    pub shares_camera_rays: bool,
    pub compiled: Compiled,
}

impl Entry {
    /// Creates the entry of an estimator from its type's constants.
    pub const fn of<E: Estimator>(name: &'static str, about: &'static str) -> Self {
        Self {
            name,
            about,
            spp_multiple: E::SPP_MULTIPLE,
            max_depth: E::MAX_DEPTH,
            aims: E::AIMS,
            roulette: E::ROULETTE,
            is_one_path: E::IS_ONE_PATH,
            largest_depth: E::LARGEST_DEPTH,
            shares_camera_rays: E::SHARES_CAMERA_RAYS,
            compiled: E::COMPILED,
        }
    }
}

/// The entry of the estimator of that name; `None` if there is none.
pub fn find(name: &str) -> Option<&'static Entry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}

/// The options that every estimator accepts.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// The bounce limit, whatever the throughput; `None` for the estimator's default.
    pub max_depth: Option<u16>,
    /// The rule of Russian roulette; `None` for the estimator's default.
    pub roulette: Option<Roulette>,
    /// Camera rays per sample; `None` for one.
    pub camera_rays: Option<u16>,
}

impl Options {
    /// Camera rays per sample.
    pub fn camera_rays(&self) -> u16 {
        self.camera_rays.unwrap_or(1).max(1)
    }
}

macro_rules! estimators {
    ($($name:literal, $about:literal => $estimator:ty, $new:path;)*) => {
        /// The estimators, in the order in which they are listed.
        pub const ESTIMATORS: &[Entry] =
            &[$(Entry::of::<$estimator>($name, $about)),*];

        /// Calls the visitor with the estimator of that name; `None` if there is none.
        pub fn with_estimator<V: EstimatorVisitor>(name: &str, options: Options, visitor: V) -> Option<V::Output> {
            match name {
                $($name => Some(visitor.visit($new(options))),)*
                _ => None,
            }
        }
    };
}

/// The estimator of that name, boxed as a trait object; `None` if there is none.
pub fn any_estimator(name: &str, options: Options) -> Option<Box<dyn AnyEstimator>> {
    struct Boxed;
    impl EstimatorVisitor for Boxed {
        type Output = Box<dyn AnyEstimator>;
        fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output {
            Box::new(estimator)
        }
    }
    with_estimator(name, options, Boxed)
}

estimators! {
    "smallpt", "smallpt's estimator: glass splits at the first two vertices, roulette after the fifth" => Smallpt, Smallpt::new;
    "bsdf", "the same transport without splitting: one direction at every vertex" => Bsdf, Bsdf::new;
    "nee", "next-event estimation: a shadow ray from every vertex to one light" => Path<Nee>, Path::nee;
    "mis", "multiple importance sampling of lights and directions, by the power heuristic" => Path<Nee>, Path::mis;
    "whitted", "Whitted's method of 1980: point lights, ideal mirrors and glass, no diffuse interreflection; 10 bounces" => Whitted, Whitted::new;
}
