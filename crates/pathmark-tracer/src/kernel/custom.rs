//! User-defined estimators, which are in no table.

use crate::estimator::{AnyEstimator, Entry, Estimator};
use std::sync::Arc;

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
