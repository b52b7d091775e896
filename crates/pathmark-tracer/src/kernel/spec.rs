//! Specification of a render by names: its *what*.

use crate::math::Precision;
use serde::{Deserialize, Serialize};

/// Specification of a kernel: the *what* of a render.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Spec {
    pub width: u32,
    pub height: u32,
    pub seed: u64,
    pub estimator: String,
    pub sampler: String,
    pub kernel: String,
    /// Instruction set of lanes by name; the fastest of this processor if `None`.
    #[serde(default)]
    pub simd: Option<String>,
    /// Floating-point format by name.
    #[serde(default = "double")]
    pub precision: String,
    /// Effect profile by name; the smallest that covers the scene if `None`.
    pub effects: Option<String>,
    /// Accelerator by name; `None` chooses it by the number of primitives.
    pub accelerator: Option<String>,
    /// Bounces after which a path is cut; `None` leaves it to the estimator.
    pub max_depth: Option<u16>,
    /// Camera rays of a sample, whose radiance is averaged; `None` for one.
    #[serde(default)]
    pub camera_rays: Option<u16>,
    /// Russian roulette, as [`Roulette`](crate::estimator::Roulette) reads it; `None` leaves it to the estimator.
    #[serde(default)]
    pub roulette: Option<String>,
    /// The clamp, as [`Clamp`](super::Clamp) reads it: biased.
    #[serde(default)]
    pub clamp: Option<String>,
    /// Pixel filter by name; the camera's own if `None`.
    #[serde(default)]
    pub filter: Option<String>,
    /// Distance in the scene's lengths below which nothing is hit, as in programs that do not know the primitive a ray
    /// starts on: biased. With `None` or "none" that primitive is known exactly.
    #[serde(default)]
    pub epsilon: Option<String>,
}

/// The only format of specs that were written before there was a choice.
fn double() -> String {
    Precision::F64.name().to_string()
}

impl Default for Spec {
    fn default() -> Self {
        Self {
            width: 256,
            height: 192,
            seed: 1,
            estimator: "smallpt".to_string(),
            sampler: "independent".to_string(),
            kernel: "lanes".to_string(),
            simd: None,
            precision: double(),
            effects: None,
            accelerator: None,
            max_depth: None,
            camera_rays: None,
            roulette: None,
            clamp: None,
            filter: None,
            epsilon: None,
        }
    }
}
