//! The entry of devices: whether one can render a scene with given settings, and which one.

use super::on_device::OnDevice;
use super::tables::{SAMPLERS, is_known};
use crate::lanes::MOST_IN_LANES;
use crate::processor::DEVICE_NAME;
use crate::sampler::InLanes as LaneSampler;
use pathmark_device::Listed;
use pathmark_tracer::error::{Error, InputError, Result};
use pathmark_tracer::estimator::PathRules;
use pathmark_tracer::kernel::{Kernel, KernelEntry, KernelPlan, Planned, RenderOptions, Request};
use pathmark_tracer::math::Precision;
use pathmark_tracer::scene::{ANGULAR_EMISSION, FAULTS, FOG, LENS, POINT_LIGHT, Scene};
use std::io;
use std::sync::Arc;

/// The kernel for devices. `device` selects the first GPU, `device:ID` the device of that name.
pub(crate) const DEVICE: KernelEntry = KernelEntry {
    is_named: Some(|text| text.split(':').next() == Some(DEVICE_NAME) && !text.contains('+')),
    listed: Some(listed),
    ..KernelEntry::new(DEVICE_NAME, "on a device, bit-identical to the others", plan)
};

/// The kernels of the devices of this machine.
fn listed() -> Vec<String> {
    let there = pathmark_device::list().into_iter().filter(|listed| listed.is_there);
    there.map(|listed| format!("{DEVICE_NAME}:{}", listed.id)).collect()
}

/// The feature of a scene or of its settings that the program has no code for.
fn obstacle(request: &Request<'_>) -> Option<&'static str> {
    let Request { scene, spec, precision, epsilon, .. } = request;
    let is_single = *precision == Precision::F32;
    let is_unknown = |index: usize| !is_known(&scene.objects[index].material);
    let obstacles = [
        (scene.effects().cover(FOG), "fog"),
        (scene.effects().cover(ANGULAR_EMISSION), "angular-emission"),
        (scene.effects().cover(FAULTS), "faults"),
        ((0..scene.objects.len()).any(is_unknown), "material"),
        (spec.clamp.is_some(), "clamp"),
        (epsilon.is_some(), "epsilon"),
        // Lanes have no code for these either.
        (is_single && scene.effects().cover(LENS), "lens"),
        (is_single && scene.effects().cover(POINT_LIGHT), "point-light"),
        (is_single && scene.owners.len() >= MOST_IN_LANES, "primitives"),
    ];
    obstacles.into_iter().find(|(is_there, _)| *is_there).map(|(_, name)| name)
}

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

pub(super) fn missing(kernel: &str) -> Error {
    let (all, named) = (pathmark_device::list(), kernel.split_once(':').map(|(_, id)| id));
    let missing = all.iter().filter(|listed| !listed.is_there);
    let why: Vec<String> = missing.map(|listed| format!("{}: {}", listed.id, listed.about)).collect();
    let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
    let problem = match named {
        Some(id) => format!("there is no device {id} here{why}"),
        None => format!("there is no GPU here{why}"),
    };
    let ids = all.iter().filter(|listed| listed.is_there).map(|listed| format!("{DEVICE_NAME}:{}", listed.id));
    let allowed: Vec<String> = ids.collect();
    InputError::new("kernel", kernel, problem).allowed(allowed.join(", ")).into()
}

/// The requested device: the named one, or else the first GPU, if there is one.
fn chosen(kernel: &str) -> Result<Option<String>> {
    let all = pathmark_device::list();
    let there = |wanted: &dyn Fn(&Listed) -> bool| all.iter().find(|listed| listed.is_there && wanted(listed));
    let named = kernel.split_once(':').map(|(_, id)| id);
    let found = match named {
        Some(id) => there(&|listed| listed.id == id),
        None => there(&|listed| listed.is_accelerator),
    };
    if let Some(found) = found {
        return Ok(Some(found.id.clone()));
    }
    // A broken driver may hide the requested device.
    let is_meant = |listed: &&Listed| named.map_or(listed.is_accelerator, |id| id.starts_with(&listed.id));
    if let Some(broken) = all.iter().filter(is_meant).find(|listed| listed.is_broken) {
        return Err(Error::system("opening", named.unwrap_or(&broken.id), io::Error::other(broken.about.clone())));
    }
    if named.is_none() { Ok(None) } else { Err(missing(kernel)) }
}

/// The device that renders a request, or the feature that the program has no code for.
pub(super) fn device_for(request: &Request<'_>) -> Result<std::result::Result<ForDevice, &'static str>> {
    if let Some(level) = request.simd {
        let problem = "applies only to lanes, and a device has none";
        return Err(InputError::new("simd", level, problem).allowed("no instruction set").into());
    }
    let precision = request.precision;
    let id = chosen(request.kernel)?;
    // Single precision has only the samplers of lanes.
    let sampler = &request.spec.sampler;
    let is_there = precision == Precision::F64 || LaneSampler::find(sampler).is_some();
    let sampler = (0..).zip(SAMPLERS).find(|(_, (name, _))| is_there && name == sampler);
    let sampler = sampler.map(|(number, _)| number);
    Ok(match (obstacle(request), request.rules, sampler) {
        (None, Some(rules), Some(sampler)) => {
            let kernel = id.as_ref().map_or_else(|| DEVICE_NAME.to_string(), |id| format!("{DEVICE_NAME}:{id}"));
            Ok(ForDevice { kernel, id, rules, precision, sampler })
        }
        (Some(reason), ..) => Err(reason),
        (None, None, _) => Err("estimator"),
        (None, Some(_), None) => Err("sampler"),
    })
}

fn plan(request: &Request<'_>) -> Result<Planned> {
    Ok(match device_for(request)? {
        Ok(device) => Planned::Ready(Arc::new(device)),
        Err(reason) => Planned::Unsupported(reason),
    })
}

impl KernelPlan for ForDevice {
    fn name(&self) -> &str {
        &self.kernel
    }

    fn precision(&self) -> Precision {
        self.precision
    }

    fn lacks_device(&self) -> bool {
        self.id.is_none()
    }

    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        Ok(Box::new(OnDevice::new(&options.prepared(scene), options, self)?))
    }
}
