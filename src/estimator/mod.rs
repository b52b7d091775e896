//! How the radiance along a camera ray is estimated. One estimator a file; this file is their table.
//!
//! To add one: write its file with a type that implements [`Estimator`], and give it a line in `estimators!` below.

mod bsdf;
mod path;
mod smallpt;

use crate::material::EffectSet;
use crate::math::{Ray, Rgb};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::Scene;

pub use bsdf::Bsdf;
pub use path::MAX_BOUNCES;
pub use smallpt::Smallpt;

/// Told what a path does. The empty implementation `()` costs nothing.
pub trait Probe {
    /// A ray was traced.
    fn ray(&mut self) {}
    /// A ray met nothing: in a closed scene, a leak.
    fn escaped(&mut self) {}
    /// A path was cut at [`MAX_BOUNCES`].
    fn truncated(&mut self) {}
}

impl Probe for () {}

/// An unbiased estimate of radiance, one sample at a time.
pub trait Estimator: Send + Sync {
    /// Samples per pixel must be a multiple of this.
    const SPP_MULTIPLE: u32;

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
}

macro_rules! estimators {
    ($($name:literal, $about:literal => $estimator:ident;)*) => {
        /// The estimators, in the order in which they are listed.
        pub const ESTIMATORS: &[Entry] =
            &[$(Entry { name: $name, about: $about, spp_multiple: <$estimator as Estimator>::SPP_MULTIPLE }),*];

        /// Calls the visitor with the estimator of that name; `None` if there is none.
        pub fn with_estimator<V: EstimatorVisitor>(name: &str, visitor: V) -> Option<V::Output> {
            match name {
                $($name => Some(visitor.visit($estimator)),)*
                _ => None,
            }
        }
    };
}

estimators! {
    "smallpt", "smallpt's own: glass splits at the first two vertices, roulette after the fifth" => Smallpt;
    "bsdf", "the same transport without splitting: one direction at every vertex" => Bsdf;
}
