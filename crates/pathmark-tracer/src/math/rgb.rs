//! A colour: radiance in W sr⁻¹ m⁻² per channel, or a dimensionless albedo or throughput.

use super::Real;
use serde::{Deserialize, Serialize};
use std::ops::{Add, AddAssign, Mul};

/// Linear red, green and blue. In TOML: `[0.75, 0.25, 0.25]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(
    from = "[T; 3]",
    into = "[T; 3]",
    bound(serialize = "T: Clone + Serialize", deserialize = "T: Deserialize<'de>")
)]
pub struct Rgb<T = f64> {
    pub r: T,
    pub g: T,
    pub b: T,
}

impl Rgb {
    /// No light.
    pub const BLACK: Self = Self { r: 0.0, g: 0.0, b: 0.0 };
    /// One in every channel.
    pub const WHITE: Self = Self { r: 1.0, g: 1.0, b: 1.0 };

    /// The largest channel: the survival probability of smallpt's Russian roulette.
    #[inline(always)]
    pub fn max_channel(self) -> f64 {
        self.r.max(self.g).max(self.b)
    }

    /// Whether every channel is zero: no light that a path still finds could reach the film.
    #[inline(always)]
    pub fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }

    /// Whether any channel is above zero; false if all are NaN.
    #[inline(always)]
    pub fn has_light(self) -> bool {
        self.r > 0.0 || self.g > 0.0 || self.b > 0.0
    }

    /// Whether every channel is a finite radiance, zero or more.
    #[inline(always)]
    pub fn is_valid_radiance(self) -> bool {
        let valid = |channel: f64| (0.0..f64::INFINITY).contains(&channel);
        valid(self.r) && valid(self.g) && valid(self.b)
    }

    /// The same function of each channel.
    #[inline(always)]
    #[must_use]
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self { r: of(self.r), g: of(self.g), b: of(self.b) }
    }

    #[inline(always)]
    pub fn channels(self) -> [f64; 3] {
        [self.r, self.g, self.b]
    }
}

impl<T: Real> Rgb<T> {
    /// The same colour in every lane.
    #[inline(always)]
    pub fn splat(colour: Rgb) -> Self {
        Self { r: T::splat(colour.r), g: T::splat(colour.g), b: T::splat(colour.b) }
    }

    /// Channel by channel: `yes` where the mask holds, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self { r: T::select(mask, yes.r, no.r), g: T::select(mask, yes.g, no.g), b: T::select(mask, yes.b, no.b) }
    }

    /// The largest channel; no channel may be NaN.
    #[inline(always)]
    pub fn largest(self) -> T {
        let larger = T::select(self.r.lt(self.g), self.g, self.r);
        T::select(larger.lt(self.b), self.b, larger)
    }
}

impl<T> From<[T; 3]> for Rgb<T> {
    fn from([r, g, b]: [T; 3]) -> Self {
        Self { r, g, b }
    }
}

impl<T> From<Rgb<T>> for [T; 3] {
    fn from(rgb: Rgb<T>) -> Self {
        [rgb.r, rgb.g, rgb.b]
    }
}

impl<T: Real> Add for Rgb<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { r: self.r + o.r, g: self.g + o.g, b: self.b + o.b }
    }
}

impl<T: Real> AddAssign for Rgb<T> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<T: Real> Mul for Rgb<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { r: self.r * o.r, g: self.g * o.g, b: self.b * o.b }
    }
}

impl<T: Real> Mul<T> for Rgb<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Self { r: self.r * s, g: self.g * s, b: self.b * s }
    }
}
