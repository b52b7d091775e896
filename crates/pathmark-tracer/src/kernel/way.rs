//! Selection of the kernel: the requested one, or the scalar kernel where that one has no code for a feature.

use super::choice::unknown;
use super::device::{ForDevice, device_for, missing};
use super::in_lanes::{InLanes, lanes_for, level, precision};
use super::{DEVICE, DEVICE_KERNEL, KERNELS, LANES, SCALAR, Spec};
use crate::error::{InputError, Result};
use crate::estimator::PathRules;
use crate::scene::Scene;
use crate::simd::{LEVELS, Precision};

/// A kernel and the settings that it is built from.
#[derive(Clone)]
pub(super) enum Way {
    /// Paths in SIMD lanes.
    Lanes(InLanes),
    /// On a device.
    Device(ForDevice),
    /// A kernel of the processor, with devices beside it.
    Beside {
        /// Name of the combination.
        kernel: String,
        /// The processor's kernel.
        own: Box<Way>,
        /// The devices.
        devices: Vec<ForDevice>,
    },
    /// One path at a time.
    Scalar {
        /// The feature that the requested kernel has no code for; empty if the scalar kernel was requested.
        instead_because: &'static str,
    },
}

impl Way {
    /// Floating-point format of the computation.
    pub(super) fn precision(&self) -> Precision {
        match self {
            Self::Lanes(lanes) => lanes.precision,
            Self::Device(device) => device.precision,
            Self::Beside { own, .. } => own.precision(),
            Self::Scalar { .. } => Precision::F64,
        }
    }

    /// The settings of the lanes, if there are any.
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

/// The processor's kernel with devices beside it. If either has no code for a feature, the processor renders alone,
/// because all kernels must produce the same bits.
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
                let problem = "is not a device, and only devices can follow a `+`";
                let allowed = format!("{DEVICE}, or {DEVICE}:ID");
                return Err(InputError::new("kernel", device, problem).allowed(allowed).into());
            }
        }
    }
    Ok(Way::Beside { kernel, own: Box::new(own), devices: all })
}
