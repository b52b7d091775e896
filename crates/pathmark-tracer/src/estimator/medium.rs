//! What a path travels through: fog, except inside of what transmits light.

use crate::effect::EffectSet;
use crate::math::Vec3;
use crate::scene::{FOG, Fog, Hit, Scene};

/// How many transmitting surfaces a part of a path has entered and not left again. What stands inside glass, where no surface of the glass
/// has been left last, is in no fog either.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Medium(u8);

impl Medium {
    /// Inside of nothing.
    pub(super) const OUTSIDE: Self = Self(0);

    /// The medium behind a surface, for light that leaves it along the local direction `wi`.
    #[inline(always)]
    pub(super) fn beyond<X: EffectSet>(self, hit: &Hit, wi: Vec3) -> Self {
        if !X::EFFECTS.cover(FOG) || wi.z >= 0.0 {
            return self;
        }
        // A camera inside glass leaves what it has never entered.
        Self(if hit.inside { self.0.saturating_sub(1) } else { self.0.saturating_add(1) })
    }

    /// The fog here, if any.
    #[inline(always)]
    pub(super) fn fog<X: EffectSet>(self, scene: &Scene) -> Option<&Fog> {
        if X::EFFECTS.cover(FOG) && self == Self::OUTSIDE { scene.fog.as_ref() } else { None }
    }
}
