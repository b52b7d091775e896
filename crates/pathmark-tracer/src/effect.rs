//! What a scene can call for, as a set of bits. Kernels are compiled for such sets, so what a scene does not use costs it nothing.
//!
//! Materials, primitives and the scene's other features each have a range of bits; their tables hand them out in order.

/// A set of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effects(u32);

/// Bits of materials; those of primitives come next, then the features.
const MATERIALS: u32 = 16;
const PRIMITIVES: u32 = 6;

impl Effects {
    /// No effect.
    pub const NONE: Self = Self(0);

    /// The effect of the material with this place in its table.
    pub const fn material(index: u32) -> Self {
        assert!(index < MATERIALS, "no bits are left for materials");
        Self(1 << index)
    }

    /// The effect of the primitive with this place in its table.
    pub const fn primitive(index: u32) -> Self {
        assert!(index < PRIMITIVES, "no bits are left for primitives");
        Self(1 << (MATERIALS + index))
    }

    /// The effect of the feature with this place in its table.
    pub const fn feature(index: u32) -> Self {
        Self(1 << (MATERIALS + PRIMITIVES + index))
    }

    /// The effects of both.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether both are the same; `==` is no constant.
    pub const fn is(self, other: Self) -> bool {
        self.0 == other.0
    }

    /// Whether every effect of `other` is in `self`.
    pub const fn cover(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The effects that a kernel is compiled for. What is not in it costs no branch: the test is on a constant.
pub trait EffectSet: Send + Sync + 'static {
    /// The set.
    const EFFECTS: Effects;
}

/// One line of a table of effects.
pub struct Entry {
    /// Its name in scene files and listings.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// Its bit.
    pub effect: Effects,
}

/// Every effect of some tables. The tables are constants, so this is one too.
pub const fn all(table: &[Entry]) -> Effects {
    let (mut effects, mut index) = (Effects::NONE, 0);
    while index < table.len() {
        effects = effects.and(table[index].effect);
        index += 1;
    }
    effects
}
