//! The points that rays met, and the properties of the surfaces there.

use super::packet::differ;
use crate::simd::Float;
use pathmark_tracer::math::{Frame, Rgb, Vec3, other_root};

/// Intersection points of a packet of rays.
#[derive(Clone, Copy)]
pub(super) struct Arrival<V: Float> {
    /// The lanes for which the other fields hold.
    pub(super) lanes: V::Mask,
    pub(super) t: V,
    pub(super) primitive: V,
    pub(super) point: Vec3<V>,
    /// The point relative to the centre of a sphere; meaningless on a flat surface.
    pub(super) from_center: Vec3<V>,
    pub(super) is_round: V::Mask,
    /// The outward normal.
    pub(super) normal: Vec3<V>,
    /// Whether the ray comes from the inside.
    pub(super) inside: V::Mask,
    /// Frame whose normal is on the ray's side.
    pub(super) frame: Frame<V>,
}

/// Properties of vertices that are known before their points.
#[derive(Clone, Copy)]
pub(super) struct Vertex<V: Float> {
    /// Number of vertices up to and including this one.
    pub(super) number: V::Bits,
    pub(super) albedo: Rgb<V>,
    /// The [`Kind`] of surface.
    pub(super) kind: V,
}

/// Distance at which rays along the local direction `wi` meet their surface again; NaN if they do not.
#[inline(always)]
pub(super) fn own_root<V: Float>(at: &Arrival<V>, wi: Vec3<V>, direction: Vec3<V>) -> V {
    let to_inside = differ(wi.z.lt(V::splat(0.0)), at.inside);
    V::select(at.is_round & to_inside, other_root(at.from_center, direction), V::splat(f64::NAN))
}
