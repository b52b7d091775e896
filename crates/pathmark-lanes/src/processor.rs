//! The kernels of the processor, which every machine has.

use crate::lanes::LANES;
use crate::level::level;
use pathmark_tracer::kernel::{KernelEntry, Request};

/// Refuses unknown instruction sets also where the scalar kernel renders, which has none.
const SCALAR: KernelEntry = KernelEntry {
    plan: |request: &Request<'_>| {
        level(request.simd)?;
        (pathmark_tracer::kernel::SCALAR.plan)(request)
    },
    ..pathmark_tracer::kernel::SCALAR
};

/// The kernels of the processor, in the order in which they are listed.
pub const ON_PROCESSOR: &[KernelEntry] = &[LANES, SCALAR];

/// Name of the kernel for devices, before a colon and the device's own name. Rows may have it although this program was
/// built without the feature `device`.
pub const DEVICE_NAME: &str = "device";
