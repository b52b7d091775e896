//! Hits of triangles that are rounding alone, and the search that leaves them out.
//!
//! A search goes by numbers of the ray's origin and of corners, all of which are rounded, and so can take for a hit what is none in two ways.
//! *A neighbour*: where a ray starts on one triangle within rounding of another, it may seem to start before that one, or behind it. *A sliver*: a
//! triangle that looks so thin to the ray that its edge functions are noise is met anywhere along its length, if at all.
//!
//! A hit is *sure* if rounding does not matter to it. The point where it meets must be in the triangle's box, as far as coordinates are. And if it
//! starts near that triangle's plane, on another one, that triangle must have a corner in front of the plane which the ray leaves, and the ray must
//! come from the side on which the other one is; so much follows from corners alone, and does not ask how exactly the ray's origin is known.
//!
//! The first hit of all that are sure, F, is what every search finds. A search returns its nearest hit; if that is near or not in its box
//! ([`Primitives::is_doubtful`]), [`Primitives::surely_nearest`] searches again for sure ones alone; lanes do so by a tree whose boxes are larger.
//! A search without a hierarchy looks at every hit, so a sure one that it returns is F. One by a hierarchy may pass by hits that are not in their
//! boxes, but none that is sure: its point, at distance t, is at most 32 u (|b| + |o|) outside of its box, rounding that point moves it by 6 u (|b| +
//! |o|), and boxes are padded by 64 u (|b| + |o|), so that after another 6 u for their own test they begin no farther than t. (u is the unit of
//! rounding, |o| and |b| are the largest coordinates of the ray's origin and of the box.) If its nearest hit is sure, F was not farther than any
//! limit on the way, was found and is what it returns.

use super::{Bounds, Nearest, Primitive, Primitives, Standpoint, Triangle};
use crate::math::{Ray, Vec3, dot};
use crate::scene::hierarchy::{Hierarchy, Tests, padding};
use crate::scene::{AllEffects, Hit};

/// How near to the plane of what it meets a ray may start and still be no reason for doubt, for each unit of the largest coordinates of the ray's origin
/// and of the triangle, with numbers of so many digits: the square root of a unit in the last place and a few digits less. What is nearer is looked
/// at again, which costs time and nothing else.
pub const fn nearness(digits: u32) -> f64 {
    1.0 / (1_u64 << (digits * 5 / 8)) as f64
}

/// The largest of a vector's coordinates, whatever their signs.
fn largest(v: Vec3) -> f64 {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// What there is to doubt about a hit.
struct Looks {
    /// Whether the ray starts near the triangle's plane.
    is_near: bool,
    /// Whether the point is in the triangle's box, as far as coordinates are.
    is_inside: bool,
}

impl Triangle {
    /// What there is to doubt about its being hit at distance `t`.
    #[inline(always)]
    fn looks(&self, ray: &Ray, t: f64, normal: Vec3, digits: u32) -> Looks {
        let bounds = Bounds::of_points(&self.corners);
        let reach = bounds.largest() + largest(ray.origin);
        let Bounds { low, high } = bounds.grown(0.5 * padding(f64::MANTISSA_DIGITS) * reach);
        let Vec3 { x, y, z } = ray.at(t);
        Looks {
            is_near: t * dot(normal, ray.direction).abs() <= nearness(digits) * reach,
            is_inside: low[0] <= x && x <= high[0] && low[1] <= y && y <= high[1] && low[2] <= z && z <= high[2],
        }
    }

    /// Whether a ray in that direction, which starts on this triangle, can meet another one.
    fn can_reach(&self, direction: Vec3, other: &Self) -> bool {
        let normals = [self, other].map(|triangle| triangle.normal(triangle.corners[0]));
        let slack = 0.5
            * padding(f64::MANTISSA_DIGITS)
            * [self, other].map(|triangle| Bounds::of_points(&triangle.corners).largest()).iter().sum::<f64>();
        // How far corners are above a plane.
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
    /// The triangle of that number, if it is one.
    #[inline(always)]
    pub(crate) fn triangle(&self, primitive: u32) -> Option<&Triangle> {
        self.triangles.get((primitive as usize).checked_sub(self.spheres.len() + self.planes.len())?)
    }

    /// Whether a hit may be of a triangle and not sure.
    #[inline(always)]
    pub(in crate::scene) fn is_doubtful(&self, ray: &Ray, hit: &Hit) -> bool {
        self.triangle(hit.primitive).is_some_and(|triangle| {
            let Looks { is_near, is_inside } = triangle.looks(ray, hit.t, hit.normal, f64::MANTISSA_DIGITS);
            is_near || !is_inside
        })
    }

    /// The first primitive along the ray that is nearer than `limit` and surely hit. Rays are as exact as numbers of so many digits.
    #[cold]
    #[inline(never)]
    pub(in crate::scene) fn surely_nearest(
        &self,
        hierarchy: Option<&Hierarchy>,
        ray: &Ray,
        from: Option<Standpoint>,
        (limit, digits): (f64, u32),
        tests: &mut Tests,
    ) -> Nearest {
        let distance = self.sure_distances(ray, from, digits);
        let none = Nearest::than(limit);
        if let Some(hierarchy) = hierarchy {
            let endless = self.endless::<AllEffects>(ray, from, none);
            return hierarchy.nearest(ray, endless, tests, distance);
        }
        let all = 0..self.counts().iter().sum::<usize>() as u32;
        all.fold(none, |nearest, primitive| nearest.or_in_any_order(distance(primitive), primitive))
    }

    /// The distance along a ray, which is as exact as numbers of so many digits, to the primitive of each number; NaN where it is not surely met.
    pub(crate) fn sure_distances(&self, ray: &Ray, from: Option<Standpoint>, digits: u32) -> impl Fn(u32) -> f64 {
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
