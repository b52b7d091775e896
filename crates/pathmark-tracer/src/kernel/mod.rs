//! Kernels: the execution of an estimator over a piece of the film. A kernel knows nothing of threads.

mod choose;
mod clamp;
mod custom;
mod entry;
mod inspect;
mod options;
mod path_rays;
mod rays;
mod recursion_clamp;
mod render;
mod scalar;
mod scalar_plan;
mod spec;
pub mod workload;

pub use choose::{Tables, choose};
pub use clamp::{Clamp, Clamped};
pub use custom::CustomEstimator;
pub use entry::{KernelEntry, Planned, Request};
pub use inspect::{BounceRow, Event, Inspector, LightByBounce, PathLog};
pub use options::{KernelPlan, RenderOptions, unknown};
pub use path_rays::{RaySearch, path_rays};
pub use rays::{FirstHits, FoundRays, Start};
pub use render::{Counts, DeviceCosts, Kernel, one_sample};
pub use scalar_plan::SCALAR;
pub use spec::Spec;

/// Version of the arithmetic. It changes when the same settings produce different bits; films of older versions are
/// then no longer used.
pub const REVISION: u32 = 4;
