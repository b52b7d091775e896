//! The settings of the device kernel.

use pathmark_tracer::estimator::PathRules;
use pathmark_tracer::math::Precision;

/// The settings of the device kernel.
#[derive(Debug, Clone)]
pub(super) struct ForDevice {
    /// The kernel's name with the device's name: `device:opencl:0`.
    pub(super) kernel: String,
    /// The device's name; `None` if any GPU was requested and there is none.
    pub(super) id: Option<String>,
    pub(super) rules: PathRules,
    pub(super) precision: Precision,
    /// The sampler's index in [`SAMPLERS`].
    pub(super) sampler: u32,
}
