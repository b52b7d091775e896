//! Kernels: the execution of an estimator over a piece of the film. A kernel knows nothing of threads.

mod choose;
mod clamp;
mod entry;
mod inspect;
mod options;
mod rays;
mod recursion_clamp;
mod render;
mod scalar;
mod spec;
pub mod workload;

pub use choose::{Tables, choose};
pub use clamp::{Clamp, Clamped};
pub use entry::{CustomEstimator, KernelEntry, Planned, Request};
pub use inspect::{BounceRow, Event, Inspector, LightByBounce, PathLog};
pub use options::{KernelPlan, RenderOptions, unknown};
pub use rays::{FirstHits, FoundRays, RaySearch, Start, path_rays};
pub use render::{Counts, DeviceCosts, Kernel, one_sample};
pub use scalar::SCALAR;
pub use spec::Spec;

/// Version of the arithmetic. It changes when the same settings produce different bits; films of older versions are
/// then no longer used.
pub const REVISION: u32 = 4;
