//! Kernels: their interface, which the tracer defines, and the table of the built-in ones.

use crate::processor::ON_PROCESSOR;
pub use crate::processor::{DEVICE_NAME, ON_PROCESSOR as KERNELS};
use pathmark_tracer::error::Result;
pub use pathmark_tracer::kernel::choose as choose_among;
pub use pathmark_tracer::kernel::*;
use pathmark_tracer::scene::Scene;
use std::sync::Arc;

#[cfg(feature = "device")]
use crate::device::{DEVICE, HYBRID};
#[cfg(feature = "device")]
pub use pathmark_device::{Listed as Device, list as devices};

/// The built-in kernels, in the order in which they are listed.
pub const BUILT_IN: &[KernelEntry] = &[
    ON_PROCESSOR[0],
    ON_PROCESSOR[1],
    #[cfg(feature = "device")]
    DEVICE,
    #[cfg(feature = "device")]
    HYBRID,
];

pub const TABLES: Tables<'static> = Tables { kernels: BUILT_IN, estimators: &[] };

/// Resolves a spec by the built-in tables.
pub fn choose(scene: &Scene, spec: &Spec) -> Result<RenderOptions> {
    pathmark_tracer::kernel::choose(scene, spec, TABLES)
}

/// Builds the kernel for a scene, with its accelerator, from the names of built-in parts.
pub fn build(scene: &Arc<Scene>, spec: &Spec) -> Result<Box<dyn Kernel>> {
    choose(scene, spec)?.build(scene)
}

/// Builds an inspector for samples of a scene, from the names of built-in parts.
pub fn inspect(scene: &Arc<Scene>, spec: &Spec) -> Result<Inspector> {
    Inspector::new(scene, &choose(scene, spec)?)
}
