//! Effect profiles: the sets of effects that kernels are compiled for.
//!
//! A scene runs on the smallest profile that covers what it calls for, so an effect that it does not use costs nothing. `--effects
//! PROFILE` forces a larger one, which is how that cost is measured.

use crate::material::{Dielectric, Diffuse, EffectSet, Effects, Mirror};

/// A function over profiles: how a profile's name becomes a type in a kernel.
pub trait ProfileVisitor {
    /// What it returns.
    type Output;
    /// Called with the profile that was named.
    fn visit<X: EffectSet>(self) -> Self::Output;
}

/// One line of the table of profiles.
pub struct ProfileEntry {
    /// Its name on the command line and in records.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// The effects in it.
    pub effects: Effects,
}

macro_rules! profiles {
    ($($Type:ident, $name:literal, $about:literal, $effects:expr;)*) => {
        $(#[doc = $about] #[derive(Debug, Clone, Copy)] pub struct $Type;
        impl EffectSet for $Type { const EFFECTS: Effects = $effects; })*

        /// The profiles, smallest first.
        pub const PROFILES: &[ProfileEntry] =
            &[$(ProfileEntry { name: $name, about: $about, effects: $Type::EFFECTS }),*];

        /// Calls the visitor with the profile of that name; `None` if there is none.
        pub fn with_profile<V: ProfileVisitor>(name: &str, visitor: V) -> Option<V::Output> {
            match name {
                $($name => Some(visitor.visit::<$Type>()),)*
                _ => None,
            }
        }
    };
}

profiles! {
    DiffuseOnly, "diffuse", "diffuse reflection alone", Diffuse::EFFECT;
    AllEffects, "all", "every effect there is", Diffuse::EFFECT.and(Mirror::EFFECT).and(Dielectric::EFFECT);
}

/// The name of the smallest profile that covers the effects.
pub fn smallest_profile(effects: Effects) -> &'static str {
    PROFILES.iter().find(|entry| entry.effects.cover(effects)).map_or("all", |entry| entry.name)
}
