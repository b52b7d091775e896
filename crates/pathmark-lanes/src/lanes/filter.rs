//! The nearest sphere by a quick formula, confirmed by the exact one: a floating-point filter (Fortune and Van Wyk,
//! "Efficient exact arithmetic for computational geometry", 1993).
//!
//! With the scene's origin as reference, the quadratic of a ray o + t d and a sphere is
//! t² - 2 (c·d - o·d) t + |o|² - 2 c·o + |c|² - r². It takes half the work of [`first_root`] and no division, but its
//! error is of the scene's size instead of the sphere's. So the sphere that is nearest by this formula is tested again
//! by `first_root`. That root is the result only if no other sphere could come before it; otherwise the scene is
//! searched. Either way the result equals a test of all spheres by `first_root`, to the bit. The rounding of the quick
//! formula does not matter.
//!
//! Distance between quick and exact roots: the two discriminants differ by less than E = 100 u (r² + 2|c|² + 2|o|²),
//! with u = 2^-53. (First-order counts: 36 for `first_root`, of which 16 come from a direction whose length is 1 up to
//! 8 u, and 21 for the quick formula; the rest is reserve.) With E added to the quick discriminant, the quick formula
//! finds every sphere that `first_root` finds. If its root s is at least some S, the two square roots differ by at most
//! 2E/S, and so do the distances. The other rounding errors, and a wrong sign of |f|² - r², add no more than that. If s
//! is below S, nothing is sure.

use super::rays::{Found, Rays};
use super::tables::Tables;
use crate::simd::Float;
use pathmark_tracer::math::{Vec3, dot, first_root};
use pathmark_tracer::scene::Scene;

/// E is this many times r² + 2|c|² + 2|o|².
const SHARE: f64 = 128.0 / 9_007_199_254_740_992.0;
/// Largest difference between roots of rays from the scene's origin, in sizes of the scene.
const SLACK: f64 = 1.0 / 4_194_304.0;
/// The least S, in sizes of the scene.
const LEAST: f64 = 1.0 / 16_384.0;

/// The spheres of a scene.
pub(super) struct Filter {
    spheres: Vec<Quick>,
    /// Largest difference between roots of rays from the scene's origin, and its increase for each square unit of
    /// distance from there.
    slack: [f64; 2],
}

/// A sphere for the quick formula.
struct Quick {
    number: f64,
    center: Vec3,
    /// r² - |c|², plus the sphere's part of E.
    constant: f64,
    least: f64,
}

impl Filter {
    pub(super) fn of(scene: &Scene) -> Self {
        let size = scene.size();
        let spheres = scene.primitives.spheres.iter().zip(0_u32..).map(|(sphere, number)| {
            let (center, r2) = (sphere.center, sphere.radius * sphere.radius);
            let c2 = dot(center, center);
            let error = SHARE * (r2 + 2.0 * c2);
            let least = (2.0 * error / (SLACK * size)).max(LEAST * size);
            Quick { number: number.into(), center, constant: r2 - c2 + error, least }
        });
        Self { spheres: spheres.collect(), slack: [SLACK * size, 4.0 * SHARE / (LEAST * size)] }
    }

    /// The nearest sphere along each ray, and the lanes in which it is sure.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(&self, tables: &Tables, rays: &Rays<V>) -> (Found<V>, V::Mask) {
        let (origin, direction) = (rays.ray.origin, rays.ray.direction);
        let (zero, infinity) = (V::splat(0.0), V::splat(f64::INFINITY));
        let (square, along) = (dot(origin, origin), -dot(origin, direction));
        let less = V::splat(1.0 - 2.0 * SHARE) * square;
        let slack = V::splat(self.slack[0]) + V::splat(self.slack[1]) * square;
        let own_root = V::ahead(rays.own_root, rays.own_root);
        let twice = origin + origin;
        let (mut first, mut second, mut number) = (infinity, infinity, V::splat(-1.0));
        let mut grazes = zero.lt(zero);
        for sphere in &self.spheres {
            let (center, this) = (Vec3::splat(sphere.center), V::splat(sphere.number));
            let b = dot_and(direction, center, along);
            let c = dot_and(twice, center, V::splat(sphere.constant) - less);
            let root = b.about_times_plus(b, c).sqrt();
            grazes = grazes | root.lt(V::splat(sphere.least));
            // Later by the slack, so that a root that may be ahead counts as ahead.
            let later = b + slack;
            let t = V::select(rays.from.equal(this), own_root, V::ahead(later - root, later + root));
            let is_first = t.is_sooner(first);
            second = second.sooner(first.later(t));
            first = first.sooner(t);
            number = V::select(is_first, this, number);
        }
        let [x, y, z, radius] = V::rows(&tables.surfaces, number);
        let exact = first_root(origin - Vec3 { x, y, z }, direction, V::splat(1.0), radius);
        let exact = V::select(rays.from.equal(number), rays.own_root, exact);
        let is_none = number.lt(zero);
        // The runner-up's distance includes the slack, too.
        let limit = slack + slack;
        let is_sure = V::select(is_none, limit, exact + limit).lt(second) & (is_none | zero.lt(exact)) & !grazes;
        (Found { nearest: V::select(is_none, infinity, exact), primitive: number }, is_sure)
    }
}

/// The dot product plus a number.
#[inline(always)]
fn dot_and<V: Float>(a: Vec3<V>, b: Vec3<V>, number: V) -> V {
    a.x.about_times_plus(b.x, a.y.about_times_plus(b.y, a.z.about_times_plus(b.z, number)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::tests::{nearest, side_by_side, walks};
    use crate::simd::{Mask, Work, levels, on_level};
    use pathmark_tracer::kernel::Start;
    use pathmark_tracer::math::Precision;
    use pathmark_tracer::scene::{SCENES, load};

    /// Compares the filter with a test of all spheres. Returns the share of rays of which it was sure.
    struct Compare<'a>(&'a Scene, &'a [Start]);

    impl Work for Compare<'_> {
        type Output = f64;

        #[inline(always)]
        fn run<V: Float>(self) -> f64 {
            let Self(scene, starts) = self;
            let (filter, tables) = (Filter::of(scene), Tables::of(scene, Precision::F64));
            let mut sure = 0;
            for starts in starts.chunks_exact(V::LANES) {
                let (found, is_sure) = filter.nearest(&tables, &side_by_side::<V>(scene, starts));
                for lane in (0..V::LANES).filter(|lane| is_sure.bits() >> lane & 1 == 1) {
                    let (t, primitive) = nearest(scene, &starts[lane]);
                    let found = (found.nearest.lane(lane), found.primitive.lane(lane));
                    assert_eq!((found.0.to_bits(), found.1), (t.to_bits(), primitive), "{:?}", starts[lane]);
                    sure += 1;
                }
            }
            f64::from(sure) / starts.len() as f64
        }
    }

    /// A sure result equals the test of all spheres, to the bit, even near edges where two spheres are met at once. In
    /// walks the filter is sure of nearly all rays.
    #[test]
    fn sure_answers_are_right() {
        let mut scenes = 0;
        for (name, _) in SCENES {
            let scene = load(name).unwrap();
            // One sphere has no edge to another.
            if !scene.is_round() || scene.hierarchy.is_some() || scene.owners.len() < 2 {
                continue;
            }
            scenes += 1;
            let (walks, edges) = walks(&scene, 10_000);
            assert!(edges.len() > 1000, "{name}: {} rays near edges", edges.len());
            for level in levels() {
                let sure = [&walks, &edges].map(|rays| on_level(level, Precision::F64, Compare(&scene, rays)));
                println!("{name} {}: sure of {sure:?}, in walks and near edges", level.name());
                assert!(sure[0] > 0.98 && sure[1] < sure[0], "{name} {}: sure of {sure:?}", level.name());
            }
        }
        assert!(scenes > 5, "{scenes} scenes of spheres");
    }
}
