//! Doubtful hits: triangle hits that may be rounding errors, and the search that leaves them out.
//!
//! The coordinates of a ray's origin and of corners are rounded, so a search can find false hits in two ways. *A
//! neighbour*: a ray that starts on one triangle, within rounding error of another, may seem to start in front of the
//! other one or behind it. *A sliver*: if a triangle looks so thin to the ray that its edge functions are noise, the
//! ray may hit it anywhere along its length, or miss it.
//!
//! A hit is *sure* if rounding does not matter to it. Its point must be in the triangle's bounding box, within rounding
//! error of coordinates. If the ray starts near that triangle's plane, on another triangle, two more conditions apply.
//! The hit triangle must have a corner in front of the plane that the ray leaves, and the ray must come from the side
//! on which its own triangle is. Both follow from corners alone and do not depend on how exactly the ray's origin is
//! known.
//!
//! Every search finds F, the first of all sure hits. A search returns its nearest hit. If the ray starts near the plane
//! of the hit triangle, or the point is not in its box ([`Primitives::is_doubtful`]), [`Primitives::surely_nearest`]
//! searches again, for sure hits only. Lanes search again in a tree with larger boxes. A search without a hierarchy
//! tests every hit, so a sure hit that it returns is F. A search in a hierarchy may miss hits that are not in their
//! boxes, but no sure hit. The point of a sure hit, at distance t, is at most 32 u (|b| + |o|) outside its box;
//! rounding moves that point by 6 u (|b| + |o|), and boxes are padded by 64 u (|b| + |o|). So after another 6 u for
//! their own test, the boxes begin no farther than t. (u is the unit of rounding; |o| and |b| are the largest
//! coordinates of the ray's origin and of the box.) If the nearest hit is sure, F was within every limit on the way, so
//! F was found and is the result.

use super::{Bounds, Nearest, Primitive, Primitives, SurfaceOrigin, Triangle};
use crate::math::{Ray, Vec3, dot};
use crate::scene::hierarchy::{Hierarchy, Tests, padding};
use crate::scene::{AllEffects, Hit};

/// Returns the largest distance at which a ray's start counts as near the plane of the triangle that it hits. The unit
/// is the sum of the largest coordinates of the ray's origin and of the triangle; numbers have `digits` binary digits.
/// The result is a few digits less than the square root of an ulp. Hits from near starts are searched again, which only
/// costs time.
#[inline]
pub const fn nearness(digits: u32) -> f64 {
    1.0 / (1_u64 << (digits * 5 / 8)) as f64
}

/// The reasons to doubt a hit.
struct Looks {
    /// Whether the ray starts near the triangle's plane.
    is_near: bool,
    /// Whether the point is in the triangle's bounding box, within rounding error of coordinates.
    is_inside: bool,
}

impl Triangle {
    /// Returns the reasons to doubt a hit of this triangle at distance `t`.
    #[inline(always)]
    fn looks(&self, ray: &Ray, t: f64, normal: Vec3, digits: u32) -> Looks {
        let bounds = Bounds::of_points(&self.corners);
        let reach = bounds.largest() + ray.origin.largest();
        let Bounds { low, high } = bounds.grown(0.5 * padding(f64::MANTISSA_DIGITS) * reach);
        let Vec3 { x, y, z } = ray.at(t);
        Looks {
            is_near: t * dot(normal, ray.direction).abs() <= nearness(digits) * reach,
            is_inside: low[0] <= x && x <= high[0] && low[1] <= y && y <= high[1] && low[2] <= z && z <= high[2],
        }
    }

    /// Whether a ray that starts on this triangle in that direction can hit the other one.
    fn can_reach(&self, direction: Vec3, other: &Self) -> bool {
        let normals = [self, other].map(|triangle| triangle.normal(triangle.corners[0]));
        let slack = 0.5
            * padding(f64::MANTISSA_DIGITS)
            * [self, other].map(|triangle| Bounds::of_points(&triangle.corners).largest()).iter().sum::<f64>();
        // The heights of corners above a plane.
        let heights = |of: &Self, plane: &Self, normal: Vec3| of.corners.map(|p| dot(p - plane.corners[0], normal));
        let ahead = if dot(direction, normals[0]) < 0.0 { -normals[0] } else { normals[0] };
        let rises = heights(other, self, ahead).iter().any(|height| *height > slack);
        let starts = heights(self, other, normals[1]);
        let towards = dot(direction, normals[1]);
        let from_above = starts.iter().any(|height| *height > slack);
        let from_below = starts.iter().any(|height| *height < -slack);
        rises && (from_above && (from_below || towards < 0.0) || from_below && towards > 0.0)
    }
}

impl Primitives {
    /// Returns the triangle of that number; `None` if the primitive is no triangle.
    #[inline(always)]
    pub fn triangle(&self, primitive: u32) -> Option<&Triangle> {
        self.triangles.get((primitive as usize).checked_sub(self.spheres.len() + self.planes.len())?)
    }

    /// Whether a hit is on a triangle and may not be sure.
    #[inline(always)]
    pub(in crate::scene) fn is_doubtful(&self, ray: &Ray, hit: &Hit) -> bool {
        self.triangle(hit.primitive).is_some_and(|triangle| {
            let Looks { is_near, is_inside } = triangle.looks(ray, hit.t, hit.normal, f64::MANTISSA_DIGITS);
            is_near || !is_inside
        })
    }

    /// Returns the first primitive along the ray with a sure hit nearer than `limit`. The ray's coordinates have
    /// `digits` binary digits.
    #[cold]
    #[inline(never)]
    pub(in crate::scene) fn surely_nearest(
        &self,
        hierarchy: Option<&Hierarchy>,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        (limit, digits): (f64, u32),
        tests: &mut Tests,
    ) -> Nearest {
        let distance = self.sure_distances(ray, from, digits);
        let none = Nearest::than(limit);
        if let Some(hierarchy) = hierarchy {
            let beside = self.endless::<AllEffects>(ray, from, none).or_own(from, &distance);
            return hierarchy.nearest(ray, beside, tests, distance);
        }
        let all = 0..self.counts().iter().sum::<usize>() as u32;
        all.fold(none, |nearest, primitive| nearest.or_in_any_order(distance(primitive), primitive))
    }

    /// Returns a function from a primitive's number to its distance along the ray; NaN without a sure hit. The ray's
    /// coordinates have `digits` binary digits.
    #[inline]
    pub fn sure_distances(&self, ray: &Ray, from: Option<SurfaceOrigin>, digits: u32) -> impl Fn(u32) -> f64 {
        let prepared = Self::prepare(ray);
        let own = from.and_then(|from| self.triangle(from.primitive));
        move |primitive| {
            let t = self.distance::<AllEffects>(primitive, ray, &prepared, from);
            let is_sure = self.triangle(primitive).is_none_or(|triangle| {
                let normal = triangle.normal(triangle.corners[0]);
                let Looks { is_near, is_inside } = triangle.looks(ray, t, normal, digits);
                is_inside && (!is_near || own.is_none_or(|own| own.can_reach(ray.direction, triangle)))
            });
            if is_sure { t } else { f64::NAN }
        }
    }
}
