//! The medium of a path: fog, except inside transmitting objects.

use crate::effect::EffectSet;
use crate::math::Vec3;
use crate::scene::{FOG, Fog, Hit, Scene};

/// The number of transmitting surfaces that a part of a path has entered and not left. There is no fog around an object
/// inside glass, even after the path has left that object.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Medium(u8);

impl Medium {
    /// Outside all transmitting objects.
    pub(super) const OUTSIDE: Self = Self(0);

    /// The medium beyond a surface, for light that leaves it along the local direction `wi`.
    #[inline(always)]
    pub(super) fn beyond<X: EffectSet>(self, hit: &Hit, wi: Vec3) -> Self {
        if !X::EFFECTS.cover(FOG) || wi.z >= 0.0 {
            return self;
        }
        // A path from a camera inside glass leaves a surface that it has not entered.
        Self(if hit.inside { self.0.saturating_sub(1) } else { self.0.saturating_add(1) })
    }

    /// The fog here, if any.
    #[inline(always)]
    pub(super) fn fog<X: EffectSet>(self, scene: &Scene) -> Option<&Fog> {
        if X::EFFECTS.cover(FOG) && self == Self::OUTSIDE { scene.fog.as_ref() } else { None }
    }
}
