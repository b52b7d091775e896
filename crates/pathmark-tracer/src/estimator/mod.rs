//! How the radiance along a camera ray is estimated. One estimator a file; this file is their table.
//!
//! To add one: write its file with a type that implements [`Estimator`] and what makes it from [`Options`], and give it a line in `estimators!`
//! below.

mod aimed;
mod bsdf;
mod camera_ray;
mod direct;
mod medium;
mod mis;
mod nee;
mod path;
mod roulette;
mod smallpt;
mod whitted;

use crate::effect::{EffectSet, Effects};
use crate::math::{Ray, Rgb};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{AllEffects, Hit, Scene, Tests};
use std::sync::Arc;

pub use aimed::power_heuristic;
pub use bsdf::Bsdf;
pub use camera_ray::{camera_ray, camera_share, seen_besides};
pub(crate) use direct::HIDING;
pub use path::{Aimed, MAX_BOUNCES, Path};
pub(crate) use roulette::By;
pub use roulette::Roulette;
pub use smallpt::Smallpt;
pub use whitted::Whitted;

/// Told what a path does. The empty implementation `()` costs nothing.
pub trait Probe {
    /// A ray was traced, and this is what it was tested against in the hierarchy, if there is one.
    fn ray(&mut self, _tests: Tests) {}
    /// A ray met nothing: in a closed scene, a leak.
    fn escaped(&mut self) {}
    /// A path was cut at the bounce limit.
    fn truncated(&mut self) {}
    /// A vertex of the path: where a ray that set out with this throughput arrived, after so many bounces.
    fn vertex(&mut self, _bounces: u16, _ray: &Ray, _hit: &Hit, _throughput: Rgb) {}
    /// Light that a vertex after so many bounces adds to the sample.
    fn light(&mut self, _bounces: u16, _contribution: Rgb) {}
    /// Fog scattered the path at the end of a ray that set out from `ray.origin`, so far away, with this throughput left.
    fn scattered(&mut self, _bounces: u16, _ray: &Ray, _distance: f64, _throughput: Rgb) {}
    /// The path splits: its other part will be followed when this one has ended.
    fn split(&mut self, _bounces: u16) {}
    /// Roulette ends a part.
    fn roulette(&mut self) {}
    /// A part of a path ended after so many bounces.
    fn ended(&mut self, _bounces: u16) {}
    /// The code of an effect ran.
    fn used(&mut self, _effect: Effects) {}
}

impl Probe for () {}

/// A probe behind a pointer: what only looks on need not be compiled into a kernel of its own.
impl Probe for &mut dyn Probe {
    fn ray(&mut self, tests: Tests) {
        (**self).ray(tests);
    }
    fn escaped(&mut self) {
        (**self).escaped();
    }
    fn truncated(&mut self) {
        (**self).truncated();
    }
    fn vertex(&mut self, bounces: u16, ray: &Ray, hit: &Hit, throughput: Rgb) {
        (**self).vertex(bounces, ray, hit, throughput);
    }
    fn light(&mut self, bounces: u16, contribution: Rgb) {
        (**self).light(bounces, contribution);
    }
    fn scattered(&mut self, bounces: u16, ray: &Ray, distance: f64, throughput: Rgb) {
        (**self).scattered(bounces, ray, distance, throughput);
    }
    fn split(&mut self, bounces: u16) {
        (**self).split(bounces);
    }
    fn roulette(&mut self) {
        (**self).roulette();
    }
    fn ended(&mut self, bounces: u16) {
        (**self).ended(bounces);
    }
    fn used(&mut self, effect: Effects) {
        (**self).used(effect);
    }
}

/// What tells apart the estimators that follow paths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathRules {
    /// At this many vertices, counted from the first, a surface that reflects and transmits is followed both ways; at most 2.
    pub splits: u16,
    /// Whether vertices aim at light, and then whether what is found is weighted with what is arrived at.
    pub aims: Option<bool>,
    /// After so many bounces a path is cut.
    pub max_depth: u16,
    /// When and how chance ends paths.
    pub roulette: Roulette,
    /// Camera rays of a sample, over which what they see is averaged.
    pub camera_rays: u16,
}

/// The effect profiles that an estimator's scalar kernels are compiled for. Each is a copy of the whole path, and takes seconds to compile.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Compiled {
    /// The profile with every effect alone.
    WithAllEffects,
    /// Also the profile of smallpt's effects.
    Common,
    /// Every profile, so that the cost of an effect can be measured, with the sampler `independent`.
    EveryProfile,
}

/// An estimate of radiance, one sample at a time: unbiased unless it has a [`Estimator::MAX_DEPTH`] of its own.
pub trait Estimator: Send + Sync {
    /// What it is, in a line of `pathmark list estimators`.
    const ABOUT: &'static str = "an estimator from outside";

    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;

    /// Whether it aims at lights, which a scene must have been given for it.
    const AIMS: bool = false;

    /// After so many bounces a path is cut unless another number is asked for; `None` if only its throughput ends it.
    const MAX_DEPTH: Option<u16> = None;

    /// When and how chance ends its paths unless another rule is asked for; `None` if it never does.
    const ROULETTE: Option<Roulette> = None;

    /// Whether a sample is a single path.
    const IS_ONE_PATH: bool = false;

    /// The largest number of bounces that it can be asked for.
    const LARGEST_DEPTH: u16 = u16::MAX;

    /// Whether it counts the light at the end of a camera ray by [`camera_share`] if a sample has several camera rays.
    const SHARES_CAMERA_RAYS: bool = false;

    /// The effect profiles that its scalar kernels are compiled for.
    const COMPILED: Compiled = Compiled::WithAllEffects;

    /// How it follows paths, for kernels that follow many at once; `None` if it does something else.
    fn rules(&self) -> Option<PathRules> {
        None
    }

    /// The radiance along `ray` in W sr⁻¹ m⁻² per channel, as sample `key` estimates it. Where a sample has several camera rays, light at the end of this
    /// one counts by [`camera_share`], and [`seen_besides`] adds the rest.
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb;
}

/// An estimator behind a pointer, with every effect in it: for whoever looks into samples and does not count seconds. One instance serves every
/// sampler and probe; an effect that a scene does not call for changes no bit.
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

impl<E: Estimator> Estimator for Arc<E> {
    const SPP_MULTIPLE: u32 = E::SPP_MULTIPLE;
    const AIMS: bool = E::AIMS;
    const MAX_DEPTH: Option<u16> = E::MAX_DEPTH;
    const ROULETTE: Option<Roulette> = E::ROULETTE;
    const IS_ONE_PATH: bool = E::IS_ONE_PATH;
    const LARGEST_DEPTH: u16 = E::LARGEST_DEPTH;
    const SHARES_CAMERA_RAYS: bool = E::SHARES_CAMERA_RAYS;

    fn rules(&self) -> Option<PathRules> {
        (**self).rules()
    }

    #[inline(always)]
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        (**self).sample::<S, X, P>(scene, ray, key, sampler, probe)
    }
}

/// A function over estimators: how the name on the command line becomes a type in a kernel.
pub trait EstimatorVisitor {
    /// What it returns.
    type Output;
    /// Called with the estimator that was named.
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output;
}

/// One line of the table of estimators.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// Samples per pixel must be a multiple of this.
    pub spp_multiple: u32,
    /// After so many bounces a path is cut unless another number is asked for; `None` if only its throughput ends it.
    pub max_depth: Option<u16>,
    /// Whether it aims at lights.
    pub aims: bool,
    /// When and how chance ends its paths unless another rule is asked for; `None` if it never does.
    pub roulette: Option<Roulette>,
    /// Whether a sample is a single path.
    pub is_one_path: bool,
    /// The largest number of bounces that it can be asked for.
    pub largest_depth: u16,
    /// Whether a sample can have several camera rays.
    pub shares_camera_rays: bool,
    /// The effect profiles that its scalar kernels are compiled for.
    pub compiled: Compiled,
}

impl Entry {
    /// What is known of an estimator from its type.
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

/// The line of the estimator of that name.
pub fn find(name: &str) -> Option<&'static Entry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}

/// What every estimator can be told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// After so many bounces a path is cut, whatever its throughput; `None` leaves it to the estimator.
    pub max_depth: Option<u16>,
    /// When and how chance ends paths; `None` leaves it to the estimator.
    pub roulette: Option<Roulette>,
    /// Camera rays of a sample; `None` for one.
    pub camera_rays: Option<u16>,
}

impl Options {
    /// Camera rays of a sample.
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

/// The estimator of that name behind a pointer; `None` if there is none.
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
    "smallpt", "smallpt's own: glass splits at the first two vertices, roulette after the fifth" => Smallpt, Smallpt::new;
    "bsdf", "the same transport without splitting: one direction at every vertex" => Bsdf, Bsdf::new;
    "nee", "next-event estimation: a shadow ray from every vertex to one light" => Path<Aimed>, nee::new;
    "mis", "light aimed at and arrived at, weighted by the power heuristic" => Path<Aimed>, mis::new;
    "whitted", "Whitted's of 1980: point lights, ideal mirrors and glass, nothing by way of diffuse surfaces; 10 bounces" => Whitted, Whitted::new;
}
