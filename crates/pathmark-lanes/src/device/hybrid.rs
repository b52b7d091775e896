//! `--kernel lanes+device:ID`, or with several devices `lanes+device:ID+device:ID`: workers render pieces with a kernel
//! of the processor, while devices render others. All these kernels produce the same bits, so the assignment of pieces
//! changes none.

use super::on_device::OnDevice;
use super::plan::{ForDevice, device_for, missing};
use crate::processor::{DEVICE_NAME, ON_PROCESSOR};
use pathmark_tracer::error::{Error, InputError, Result};
use pathmark_tracer::film::{Piece, TileBuffer};
use pathmark_tracer::kernel::{
    Counts, DeviceCosts, FirstHits, Kernel, KernelEntry, KernelPlan, Planned, RenderOptions, Request, Start, unknown,
};
use pathmark_tracer::math::Precision;
use pathmark_tracer::scene::{Scan, Scene};
use std::sync::Arc;

/// A kernel of the processor with devices beside it.
pub(crate) const HYBRID: KernelEntry = KernelEntry {
    is_named: Some(|text| text.contains('+')),
    listed: Some(listed),
    ..KernelEntry::new("lanes+device:ID", "workers and devices together, each on other pieces", plan)
};

/// Lanes with each device of this machine.
fn listed() -> Vec<String> {
    super::DEVICE.names().iter().map(|device| format!("{}+{device}", ON_PROCESSOR[0].name)).collect()
}

/// If either kernel has no code for a feature, the processor renders alone, because all kernels must produce the same
/// bits.
fn plan(request: &Request<'_>) -> Result<Planned> {
    let (first, rest) = request.kernel.split_once('+').unwrap_or((request.kernel, ""));
    let Some(entry) = ON_PROCESSOR.iter().find(|entry| entry.is_meant_by(first)) else {
        return Err(unknown("kernel", first, ON_PROCESSOR.iter().map(|entry| entry.name)).into());
    };
    let processor = match (entry.plan)(&Request { kernel: first, ..*request })? {
        Planned::Ready(plan) => plan,
        unsupported @ Planned::Unsupported(_) => return Ok(unsupported),
    };
    let (mut name, mut devices) = (first.to_string(), Vec::new());
    for kernel in rest.split('+') {
        if !super::DEVICE.is_meant_by(kernel) {
            let problem = "is not a device, and only devices can follow a `+`";
            let allowed = format!("{DEVICE_NAME}, or {DEVICE_NAME}:ID");
            return Err(InputError::new("kernel", kernel, problem).allowed(allowed).into());
        }
        match device_for(&Request { kernel, simd: None, ..*request })? {
            Ok(ForDevice { id: None, kernel, .. }) => return Err(missing(&kernel)),
            Ok(device) => {
                name = format!("{name}+{}", device.kernel);
                devices.push(device);
            }
            Err(reason) => return Ok(Planned::Unsupported(reason)),
        }
    }
    Ok(Planned::Ready(Arc::new(HybridPlan { name, processor, devices })))
}

struct HybridPlan {
    name: String,
    processor: Arc<dyn KernelPlan>,
    devices: Vec<ForDevice>,
}

impl KernelPlan for HybridPlan {
    fn name(&self) -> &str {
        &self.name
    }

    fn simd(&self) -> &'static str {
        self.processor.simd()
    }

    fn precision(&self) -> Precision {
        self.processor.precision()
    }

    fn effects(&self) -> Option<&'static str> {
        self.processor.effects()
    }

    fn scan(&self, scene: &Scene) -> Scan {
        self.processor.scan(scene)
    }

    fn devices_beside(&self) -> usize {
        self.devices.len()
    }

    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        let prepared = options.prepared(scene);
        let devices = self.devices.iter().map(|device| OnDevice::new(&prepared, options, device));
        let devices = devices.collect::<Result<_>>()?;
        Ok(Box::new(Hybrid { processor: self.processor.build(scene, options)?, devices }))
    }

    fn first_hits(&self, scene: &Arc<Scene>, options: &RenderOptions, rays: Vec<Start>) -> Result<Box<dyn FirstHits>> {
        self.processor.first_hits(scene, options, rays)
    }
}

/// A kernel of the processor and kernels of devices.
struct Hybrid {
    processor: Box<dyn Kernel>,
    devices: Vec<OnDevice>,
}

impl Kernel for Hybrid {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        self.processor.render(piece, out)
    }

    fn failure(&self) -> Option<Error> {
        self.devices.iter().find_map(Kernel::failure)
    }

    fn remarks(&self) -> Vec<String> {
        self.devices.iter().flat_map(Kernel::remarks).collect()
    }

    fn costs(&self) -> Option<DeviceCosts> {
        self.devices
            .iter()
            .filter_map(Kernel::costs)
            .reduce(|a, b| DeviceCosts { compile_s: a.compile_s + b.compile_s, copy_s: a.copy_s + b.copy_s })
    }

    fn beside(&self) -> Vec<&dyn Kernel> {
        self.devices.iter().map(|device| device as &dyn Kernel).collect()
    }
}
