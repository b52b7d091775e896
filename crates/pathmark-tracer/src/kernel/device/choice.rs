//! Selection of a device: whether one can render a scene with given settings, and which one.

use super::super::in_lanes::{MOST_IN_LANES, precision};
use super::super::{DEVICE, Spec};
use super::tables::{SAMPLERS, is_known};
use crate::error::{Error, InputError, Result};
use crate::estimator::PathRules;
use crate::sampling::InLanes as LaneSampler;
use crate::scene::{ANGULAR_EMISSION, FOG, LENS, POINT_LIGHT, Scene};
use crate::simd::Precision;
use pathmark_device::Listed;
use std::io;

/// The settings of the device kernel.
#[derive(Debug, Clone)]
pub(in crate::kernel) struct ForDevice {
    /// The kernel's name with the device's name: `device:opencl:0`.
    pub(in crate::kernel) kernel: String,
    /// The device's name; `None` if any GPU was requested and there is none.
    pub(in crate::kernel) id: Option<String>,
    pub(super) rules: PathRules,
    pub(in crate::kernel) precision: Precision,
    /// The sampler's index in [`SAMPLERS`].
    pub(super) sampler: u32,
}

/// The feature of a scene or of its settings that the program has no code for.
fn obstacle(scene: &Scene, spec: &Spec, epsilon: Option<f64>, precision: Precision) -> Option<&'static str> {
    let is_single = precision == Precision::F32;
    let is_unknown = |index: usize| !is_known(&scene.objects[index].material);
    let obstacles = [
        (scene.effects().cover(FOG), "fog"),
        (scene.effects().cover(ANGULAR_EMISSION), "angular-emission"),
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

/// The error of a missing device.
pub(in crate::kernel) fn missing(kernel: &str) -> Error {
    let (all, named) = (pathmark_device::list(), kernel.split_once(':').map(|(_, id)| id));
    let missing = all.iter().filter(|listed| !listed.is_there);
    let why: Vec<String> = missing.map(|listed| format!("{}: {}", listed.id, listed.about)).collect();
    let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
    let problem = match named {
        Some(id) => format!("there is no device {id} here{why}"),
        None => format!("there is no GPU here{why}"),
    };
    let ids = all.iter().filter(|listed| listed.is_there).map(|listed| format!("{DEVICE}:{}", listed.id));
    let allowed: Vec<String> = ids.collect();
    InputError::new("kernel", kernel, problem).allowed(allowed.join(", ")).into()
}

/// The device that renders a scene with these settings, or the feature that the program has no code for.
pub(in crate::kernel) fn device_for(
    scene: &Scene,
    spec: &Spec,
    rules: Option<PathRules>,
    epsilon: Option<f64>,
) -> Result<std::result::Result<ForDevice, &'static str>> {
    if let Some(level) = &spec.simd {
        let problem = "applies only to lanes, and a device has none";
        return Err(InputError::new("simd", level, problem).allowed("no instruction set").into());
    }
    let precision = precision(spec)?;
    let id = chosen(&spec.kernel)?;
    // Single precision has only the samplers of lanes.
    let is_there = precision == Precision::F64 || LaneSampler::find(&spec.sampler).is_some();
    let sampler = (0..).zip(SAMPLERS).find(|(_, (name, _))| is_there && *name == spec.sampler);
    let sampler = sampler.map(|(number, _)| number);
    Ok(match (obstacle(scene, spec, epsilon, precision), rules, sampler) {
        (None, Some(rules), Some(sampler)) => {
            let kernel = id.as_ref().map_or_else(|| DEVICE.to_string(), |id| format!("{DEVICE}:{id}"));
            Ok(ForDevice { kernel, id, rules, precision, sampler })
        }
        (Some(reason), ..) => Err(reason),
        (None, None, _) => Err("estimator"),
        (None, Some(_), None) => Err("sampler"),
    })
}
