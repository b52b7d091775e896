//! Effects: the materials, primitives and features that a scene uses, as a set of bits. Kernels are compiled for such
//! sets, so a scene doesn't pay for effects it doesn't use.
//!
//! Materials, primitives and features each have a range of bits; their tables assign the bits in order.

/// A set of effects.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effects(u32);

/// Number of bits reserved for materials. Bits of primitives follow, then bits of features.
const MATERIALS: u32 = 16;
const PRIMITIVES: u32 = 6;

impl Effects {
    pub const NONE: Self = Self(0);

    /// The effect of the material at this index of its table.
    pub const fn material(index: u32) -> Self {
        assert!(index < MATERIALS, "no bits are left for materials");
        Self(1 << index)
    }

    /// The effect of the primitive at this index of its table.
    pub const fn primitive(index: u32) -> Self {
        assert!(index < PRIMITIVES, "no bits are left for primitives");
        Self(1 << (MATERIALS + index))
    }

    /// The effect of the feature at this index of its table.
    pub const fn feature(index: u32) -> Self {
        Self(1 << (MATERIALS + PRIMITIVES + index))
    }

    /// The union of both sets.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether both sets are equal; `==` can't be called in a `const fn`.
    pub const fn is(self, other: Self) -> bool {
        self.0 == other.0
    }

    /// Whether every effect of `other` is in `self`.
    pub const fn cover(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The effects that a kernel is compiled for. An effect outside the set costs no branch, because the test is on a
/// constant.
pub trait EffectSet: Send + Sync + 'static {
    const EFFECTS: Effects;
}

/// One line of a table of effects.
pub struct Entry {
    /// Its name in scene files and listings.
    pub name: &'static str,
    pub about: &'static str,
    pub effect: Effects,
}

/// The effects of all entries of `table`, as a constant expression.
pub const fn all(table: &[Entry]) -> Effects {
    let (mut effects, mut index) = (Effects::NONE, 0);
    while index < table.len() {
        effects = effects.and(table[index].effect);
        index += 1;
    }
    effects
}
