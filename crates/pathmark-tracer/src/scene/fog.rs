//! A homogeneous medium that fills the scene, except inside glass. A camera is in the fog, wherever it stands.
//!
//! ```toml
//! [fog]
//! absorption = [0.001, 0.001, 0.001]   # per unit of length
//! scattering = 0.002                   # per unit of length, evenly in all directions
//! emission = [0.0, 0.0, 0.0]           # optional: the radiance of fog without an end
//! ```
//!
//! The distance to the next scattering is sampled with density σs exp(-σs t), so only absorption remains as a weight.
//! It follows the law of Beer and Lambert, exp(-σa t), in each channel. One σs for all channels keeps the sampling
//! exact for each of them.

use crate::input::{positive, radiance};
use crate::math::Rgb;
use serde::Deserialize;

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fog {
    /// Share of light absorbed per unit of length, σa, per channel.
    #[serde(deserialize_with = "radiance")]
    pub absorption: Rgb,
    /// Share of light scattered per unit of length, σs.
    #[serde(deserialize_with = "positive")]
    pub scattering: f64,
    /// The source function: the radiance of infinitely deep fog, W sr⁻¹ m⁻² per channel.
    #[serde(default = "black", deserialize_with = "radiance")]
    pub emission: Rgb,
}

fn black() -> Rgb {
    Rgb::BLACK
}

/// Returns exp(-σt), also for infinite distances; 1 if σ is 0.
#[inline(always)]
fn kept(sigma: f64, t: f64) -> f64 {
    if sigma > 0.0 { libm::exp(-sigma * t) } else { 1.0 }
}

/// Applies a function of σ to every channel, only once if all channels are equal.
#[inline(always)]
fn by_channel(sigma: Rgb, f: impl Fn(f64) -> f64) -> Rgb {
    if sigma.r == sigma.g && sigma.g == sigma.b {
        let grey = f(sigma.r);
        return Rgb { r: grey, g: grey, b: grey };
    }
    sigma.map(f)
}

/// Returns 1 - exp(-σt), exact also for thin fog; 0 if σ is 0.
#[inline(always)]
fn lost(sigma: f64, t: f64) -> f64 {
    if sigma > 0.0 { -libm::expm1(-sigma * t) } else { 0.0 }
}

impl Fog {
    /// Returns the distance to the next scattering for a random number in [0, 1). Without scattering it is infinite,
    /// and no number is drawn.
    #[inline(always)]
    pub fn free_path(&self, draw: impl FnOnce() -> f64) -> f64 {
        // ln(1 - u) for u < 1 is finite, and exact where u is small.
        if self.scattering > 0.0 { -libm::log1p(-draw()) / self.scattering } else { f64::INFINITY }
    }

    /// The share of light that is not absorbed over a distance, per channel.
    #[inline(always)]
    pub fn transmittance(&self, t: f64) -> Rgb {
        by_channel(self.absorption, |sigma| kept(sigma, t))
    }

    /// The share of light that is neither absorbed nor scattered over a distance, per channel.
    #[inline(always)]
    pub fn unhindered(&self, t: f64) -> Rgb {
        self.transmittance(t) * kept(self.scattering, t)
    }

    /// The radiance that the fog adds over a distance without scattering, per channel: emission (1 - exp(-σa t)).
    #[inline(always)]
    pub fn glow(&self, t: f64) -> Rgb {
        if self.emission.is_black() {
            return Rgb::BLACK;
        }
        self.emission * by_channel(self.absorption, |sigma| lost(sigma, t))
    }

    /// The radiance that the fog emits over a distance and that arrives unscattered: emission σa/σt (1 - exp(-σt t))
    /// for σt = σa + σs.
    #[inline(always)]
    pub fn unhindered_glow(&self, t: f64) -> Rgb {
        if self.emission.is_black() {
            return Rgb::BLACK;
        }
        let share = |sigma: f64| {
            let all = sigma + self.scattering;
            if sigma > 0.0 { sigma / all * lost(all, t) } else { 0.0 }
        };
        self.emission * by_channel(self.absorption, share)
    }

    /// Returns the fog with every length multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { absorption: self.absorption * (1.0 / factor), scattering: self.scattering / factor, ..*self }
    }
}
