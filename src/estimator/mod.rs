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
use crate::scene::{Hit, Scene, Tests};

pub use aimed::power_heuristic;
pub use bsdf::Bsdf;
pub use camera_ray::camera_ray;
pub use path::{Aimed, MAX_BOUNCES, Path};
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Course {
    /// At this many vertices, counted from the first, a surface that reflects and transmits is followed both ways; at most 2.
    pub splits: u16,
    /// Whether vertices aim at light, and then whether what is found is weighted with what is arrived at.
    pub aims: Option<bool>,
    /// After so many bounces a path is cut.
    pub max_depth: u16,
    /// When and how chance ends paths.
    pub roulette: Roulette,
}

/// An estimate of radiance, one sample at a time: unbiased unless it has a [`Estimator::MAX_DEPTH`] of its own.
pub trait Estimator: Send + Sync {
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

    /// How it follows paths, for kernels that follow many at once; `None` if it does something else.
    fn course(&self) -> Option<Course> {
        None
    }

    /// The radiance along `ray` in W sr⁻¹ m⁻² per channel, as sample `key` estimates it.
    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb;
}

/// A function over estimators: how the name on the command line becomes a type in a kernel.
pub trait EstimatorVisitor {
    /// What it returns.
    type Output;
    /// Called with the estimator that was named.
    fn visit<E: Estimator + 'static>(self, estimator: E) -> Self::Output;
}

/// One line of the table of estimators.
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
}

/// The line of the estimator of that name.
pub fn find(name: &str) -> Option<&'static Entry> {
    ESTIMATORS.iter().find(|entry| entry.name == name)
}

/// What every estimator can be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// After so many bounces a path is cut, whatever its throughput; `None` leaves it to the estimator.
    pub max_depth: Option<u16>,
    /// When and how chance ends paths; `None` leaves it to the estimator.
    pub roulette: Option<Roulette>,
}

macro_rules! estimators {
    ($($name:literal, $about:literal => $estimator:ty, $new:path;)*) => {
        /// The estimators, in the order in which they are listed.
        pub const ESTIMATORS: &[Entry] =
            &[$(Entry {
                name: $name,
                about: $about,
                spp_multiple: <$estimator as Estimator>::SPP_MULTIPLE,
                max_depth: <$estimator as Estimator>::MAX_DEPTH,
                aims: <$estimator as Estimator>::AIMS,
                roulette: <$estimator as Estimator>::ROULETTE,
                is_one_path: <$estimator as Estimator>::IS_ONE_PATH,
                largest_depth: <$estimator as Estimator>::LARGEST_DEPTH,
            }),*];

        /// Calls the visitor with the estimator of that name; `None` if there is none.
        pub fn with_estimator<V: EstimatorVisitor>(name: &str, options: Options, visitor: V) -> Option<V::Output> {
            match name {
                $($name => Some(visitor.visit($new(options))),)*
                _ => None,
            }
        }
    };
}

estimators! {
    "smallpt", "smallpt's own: glass splits at the first two vertices, roulette after the fifth" => Smallpt, Smallpt::new;
    "bsdf", "the same transport without splitting: one direction at every vertex" => Bsdf, Bsdf::new;
    "nee", "next-event estimation: a shadow ray from every vertex to one light" => Path<Aimed>, nee::new;
    "mis", "light aimed at and arrived at, weighted by the power heuristic" => Path<Aimed>, mis::new;
    "whitted", "Whitted's of 1980: point lights, ideal mirrors and glass, nothing by way of diffuse surfaces; 10 bounces" => Whitted, Whitted::new;
}
