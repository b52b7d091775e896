//! User-defined estimators, which are in no table.

use super::scalar::Scalar;
use super::{Choice, Kernel};
use crate::estimator::{AnyEstimator, Entry, Estimator};
use crate::sampling::Sampler;
use crate::scene::{AllEffects, Scene};
use std::sync::Arc;

type Build = dyn Fn(Arc<Scene>, &Choice, Box<dyn Sampler>) -> Box<dyn Kernel> + Send + Sync;

/// A named user-defined estimator. It is compiled once, where it is written, with every effect and for any sampler.
#[derive(Clone)]
pub struct OwnEstimator {
    entry: Entry,
    any: Arc<dyn AnyEstimator>,
    build: Arc<Build>,
}

impl OwnEstimator {
    /// Wraps an estimator under a name.
    pub fn new<E: Estimator + 'static>(name: &'static str, estimator: E) -> Self {
        let estimator = Arc::new(estimator);
        let any = Arc::clone(&estimator);
        let build = move |scene: Arc<Scene>, choice: &Choice, sampler: Box<dyn Sampler>| -> Box<dyn Kernel> {
            let estimator = Arc::clone(&estimator);
            Box::new(Scalar::<Arc<E>, Box<dyn Sampler>, AllEffects>::new(scene, choice, estimator, sampler))
        };
        Self { entry: Entry::of::<E>(name, E::ABOUT), any, build: Arc::new(build) }
    }

    /// Its properties, as in the table of estimators.
    pub fn entry(&self) -> &Entry {
        &self.entry
    }

    /// The estimator behind a pointer.
    pub(super) fn any(&self) -> Arc<dyn AnyEstimator> {
        Arc::clone(&self.any)
    }

    pub(super) fn kernel(&self, scene: Arc<Scene>, choice: &Choice, sampler: Box<dyn Sampler>) -> Box<dyn Kernel> {
        (self.build)(scene, choice, sampler)
    }
}
