//! What a scene can call for besides materials and primitives.

use crate::effect::{Effects, Entry};

/// Rays are tested against boxes before primitives.
pub const HIERARCHY: Effects = Effects::feature(0);
/// Light that arrives from nowhere.
pub const BACKGROUND: Effects = Effects::feature(1);
/// Lights without a size.
pub const POINT_LIGHT: Effects = Effects::feature(2);
/// A lens instead of a pinhole.
pub const LENS: Effects = Effects::feature(3);
/// Something between the surfaces.
pub const FOG: Effects = Effects::feature(4);
/// Surfaces that give off more light in some directions than in others.
pub const ANGULAR_EMISSION: Effects = Effects::feature(5);

/// The features, in the order in which they are listed.
pub const FEATURES: &[Entry] = &[
    Entry { name: "hierarchy", about: "a bounding volume hierarchy over the primitives", effect: HIERARCHY },
    Entry { name: "background", about: "radiance of rays that meet nothing", effect: BACKGROUND },
    Entry { name: "point-light", about: "lights without a size, by inverse squares", effect: POINT_LIGHT },
    Entry { name: "lens", about: "a thin lens", effect: LENS },
    Entry { name: "fog", about: "a homogeneous medium that absorbs, scatters and glows", effect: FOG },
    Entry { name: "angular-emission", about: "emission by the angle to the normal", effect: ANGULAR_EMISSION },
];
