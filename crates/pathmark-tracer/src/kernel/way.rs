//! Which kernel renders a scene: the one that was asked for, or the scalar one where that has no code for something.

use super::choice::unknown;
use super::device::{ForDevice, device_for};
use super::in_lanes::{InLanes, lanes_for, level, precision};
use super::{DEVICE, DEVICE_KERNEL, KERNELS, LANES, SCALAR, Spec};
use crate::error::Result;
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
    /// By a kernel of the processor, and on a device beside it.
    Beside {
        /// The processor's.
        own: Box<Way>,
        /// The device's.
        device: ForDevice,
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
pub(super) fn way_for(scene: &Scene, spec: &Spec, course: Option<PathRules>, epsilon: Option<f64>) -> Result<Way> {
    let instead = |reason| Way::Scalar { instead_because: reason };
    if let Some((own_name, device)) = spec.kernel.split_once('+') {
        let by = |kernel: &str, simd: &Option<String>| {
            let spec = Spec { kernel: kernel.to_string(), simd: simd.clone(), ..spec.clone() };
            way_for(scene, &spec, course, epsilon)
        };
        // Where either has no code for something, the processor renders alone: both must have the same bits.
        return Ok(match (by(own_name, &spec.simd)?, by(device, &None)?) {
            (own @ (Way::Lanes(_) | Way::Scalar { instead_because: "" }), Way::Device(device)) => {
                let device = device.beside(own_name);
                Way::Beside { own: Box::new(own), device }
            }
            (Way::Lanes(_) | Way::Scalar { instead_because: "" }, Way::Scalar { instead_because }) => {
                Way::Scalar { instead_because }
            }
            (own, _) => own,
        });
    }
    match spec.kernel.split_once(':').map_or(spec.kernel.as_str(), |(kernel, _)| kernel) {
        DEVICE => Ok(device_for(scene, spec, course, epsilon)?.map_or_else(instead, Way::Device)),
        _ if spec.kernel == LANES => Ok(lanes_for(scene, spec, course, epsilon)?.map_or_else(instead, Way::Lanes)),
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
