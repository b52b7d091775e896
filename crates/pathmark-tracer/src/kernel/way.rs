//! Which kernel renders a scene: the one that was asked for, or the scalar one where that has no code for something.

use super::choice::unknown;
use super::device::{ForDevice, device_for, missing};
use super::in_lanes::{InLanes, lanes_for, level, precision};
use super::{DEVICE, DEVICE_KERNEL, KERNELS, LANES, SCALAR, Spec};
use crate::error::{InputError, Result};
use crate::estimator::PathRules;
use crate::scene::Scene;
use crate::simd::LEVELS;

/// A kernel with what it is made from.
#[derive(Clone)]
pub(super) enum Way {
    /// Paths side by side.
    Lanes(InLanes),
    /// On a device.
    Device(ForDevice),
    /// By a kernel of the processor, and on devices beside it.
    Beside {
        /// Name of all of it.
        kernel: String,
        /// The processor's.
        own: Box<Way>,
        /// The devices'.
        devices: Vec<ForDevice>,
    },
    /// One path at a time.
    Scalar {
        /// What the kernel that was asked for has no code for; empty if this one was asked for.
        instead_because: &'static str,
    },
}

impl Way {
    /// How lanes go about it, if they do.
    pub(super) fn lanes(&self) -> Option<&InLanes> {
        match self {
            Self::Lanes(lanes) => Some(lanes),
            Self::Beside { own, .. } => own.lanes(),
            Self::Device(_) | Self::Scalar { .. } => None,
        }
    }
}

/// The kernel for a scene with these settings.
pub(super) fn way_for(scene: &Scene, spec: &Spec, rules: Option<PathRules>, epsilon: Option<f64>) -> Result<Way> {
    let instead = |reason| Way::Scalar { instead_because: reason };
    if let Some((own, devices)) = spec.kernel.split_once('+') {
        return beside(scene, spec, (own, devices), rules, epsilon);
    }
    match spec.kernel.split_once(':').map_or(spec.kernel.as_str(), |(kernel, _)| kernel) {
        DEVICE => Ok(device_for(scene, spec, rules, epsilon)?.map_or_else(instead, Way::Device)),
        _ if spec.kernel == LANES => Ok(lanes_for(scene, spec, rules, epsilon)?.map_or_else(instead, Way::Lanes)),
        _ if spec.kernel == SCALAR => {
            level(LEVELS, spec.simd.as_deref())?;
            precision(spec)?;
            Ok(instead(""))
        }
        _ => {
            let names = KERNELS.iter().chain([&DEVICE_KERNEL]).map(|entry| entry.name);
            Err(unknown("kernel", &spec.kernel, names).into())
        }
    }
}

/// The processor's kernel and devices beside it. Where either has no code for something, the processor renders alone: all must have the same bits.
fn beside(
    scene: &Scene,
    spec: &Spec,
    (own, devices): (&str, &str),
    rules: Option<PathRules>,
    epsilon: Option<f64>,
) -> Result<Way> {
    let by = |kernel: &str, simd: Option<&String>| {
        let spec = Spec { kernel: kernel.to_string(), simd: simd.cloned(), ..spec.clone() };
        way_for(scene, &spec, rules, epsilon)
    };
    let (own_name, own) = (own, by(own, spec.simd.as_ref())?);
    if !matches!(own, Way::Lanes(_) | Way::Scalar { instead_because: "" }) {
        return Ok(own);
    }
    let (mut kernel, mut all) = (own_name.to_string(), Vec::new());
    for device in devices.split('+') {
        match by(device, None)? {
            Way::Device(ForDevice { id: None, kernel, .. }) => return Err(missing(&kernel)),
            Way::Device(device) => {
                kernel = format!("{kernel}+{}", device.kernel);
                all.push(device);
            }
            Way::Scalar { instead_because } if !instead_because.is_empty() => {
                return Ok(Way::Scalar { instead_because });
            }
            _ => {
                let problem = "is no device, and stands beside a kernel";
                let allowed = format!("{DEVICE}, or {DEVICE}:ID");
                return Err(InputError::new("kernel", device, problem).allowed(allowed).into());
            }
        }
    }
    Ok(Way::Beside { kernel, own: Box::new(own), devices: all })
}
