//! Entries of the table of kernels, and user-defined estimators, which are in no table.

use super::options::KernelPlan;
use super::spec::Spec;
use crate::error::Result;
use crate::estimator::{AnyEstimator, Entry, Estimator, PathRules};
use crate::math::Precision;
use crate::scene::Scene;
use std::sync::Arc;

/// A kernel's entry in the table. [`KernelEntry::new`] sets the fields that most kernels share.
#[derive(Debug, Clone, Copy)]
pub struct KernelEntry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    /// Whether a text names the kernel, if it takes more than its name, such as a device.
    pub is_named: Option<fn(&str) -> bool>,
    /// The names under which it is listed on this machine, if they are not its own.
    pub listed: Option<fn() -> Vec<String>>,
    /// Plans the kernel for a scene, or says which feature it has no code for.
    pub plan: fn(&Request<'_>) -> Result<Planned>,
}

impl KernelEntry {
    /// Creates the entry of a kernel that takes no parameter.
    pub const fn new(name: &'static str, about: &'static str, plan: fn(&Request<'_>) -> Result<Planned>) -> Self {
        Self { name, about, is_named: None, listed: None, plan }
    }

    /// Whether a user's text means this kernel.
    pub fn is_meant_by(&self, text: &str) -> bool {
        self.is_named.map_or(text == self.name, |is_named| is_named(text))
    }

    /// The names under which the kernel is listed on this machine.
    pub fn names(&self) -> Vec<String> {
        self.listed.map_or_else(|| vec![self.name.to_string()], |listed| listed())
    }
}

/// A request for a kernel: the settings that decide whether it can render an image.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    pub scene: &'a Scene,
    /// The settings by name.
    pub spec: &'a Spec,
    /// The kernel's name as the user wrote it.
    pub kernel: &'a str,
    /// The requested instruction set; `None` for the fastest one.
    pub simd: Option<&'a str>,
    /// The requested floating-point format.
    pub precision: Precision,
    /// The rules of the estimator's paths; `None` if it does not follow such paths.
    pub rules: Option<PathRules>,
    /// Distance below which nothing is hit.
    pub epsilon: Option<f64>,
}

/// The answer to a request.
pub enum Planned {
    /// The kernel can render the image.
    Ready(Arc<dyn KernelPlan>),
    /// It has no code for this feature; the scalar kernel renders instead, and the column `kernel_fallback` names the
    /// feature.
    Unsupported(&'static str),
}

/// A named user-defined estimator. It is compiled once, where it is written, with every effect and for any sampler.
#[derive(Clone)]
pub struct CustomEstimator {
    entry: Entry,
    any: Arc<dyn AnyEstimator>,
}

impl CustomEstimator {
    /// Wraps an estimator under a name.
    pub fn new<E: Estimator + 'static>(name: &'static str, estimator: E) -> Self {
        Self { entry: Entry::of::<E>(name, E::ABOUT), any: Arc::new(estimator) }
    }

    /// Its properties, as in the table of estimators.
    pub fn entry(&self) -> &Entry {
        &self.entry
    }

    /// The estimator behind a pointer.
    pub(super) fn any(&self) -> Arc<dyn AnyEstimator> {
        Arc::clone(&self.any)
    }
}
