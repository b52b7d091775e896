//! The first sphere by a quick formula, made sure of by the exact one: a floating-point filter (Fortune and Van Wyk, "Efficient exact arithmetic
//! for computational geometry", 1993).
//!
//! About the scene's origin the quadratic of a ray o + t d and a sphere is t² - 2 (c·d - o·d) t + |o|² - 2 c·o + |c|² - r²: half of the work of
//! [`first_root`], without a division, but with an error of the size of the scene where that has one of the size of the sphere. So the sphere
//! that is first by it is tested again by `first_root`, and that is the answer only if no other could come before it. Else the scene is asked.
//! Either way the answer is what the test of all by `first_root` would have been, to the bit; how the quick formula rounds does not matter.
//!
//! How far quick and exact roots are apart: the discriminants of both differ by less than E = 100 u (r² + 2|c|² + 2|o|²), with u = 2^-53.
//! (First-order counts: 36 for `first_root`, of which 16 come from a direction whose length is 1 up to 8 u, 21 for the quick formula, the rest
//! to spare.) With E added to the quick discriminant it sees every sphere that `first_root` does. Where its root s is not below some S, both
//! square roots differ by at most 2E/S, and so do the distances; what else is rounded, and a wrong sign of |f|² - r², is no more than that.
//! Where s is below S nothing is sure.

use super::nearest::Found;
use super::packet::Rays;
use super::tables::Tables;
use crate::math::{Vec3, dot, first_root};
use crate::scene::Scene;
use crate::simd::Float;

/// E is this many times r² + 2|c|² + 2|o|².
const SHARE: f64 = 128.0 / 9_007_199_254_740_992.0;
/// By how many sizes of the scene roots of rays from its origin may differ.
const SLACK: f64 = 1.0 / 4_194_304.0;
/// The least S, in sizes of the scene.
const LEAST: f64 = 1.0 / 16_384.0;

/// The spheres of a scene.
pub(super) struct Filter {
    spheres: Vec<Quick>,
    /// How far roots of rays from the scene's origin may be apart, and by how much more for each square unit from there.
    slack: [f64; 2],
}

/// A sphere for the quick formula.
struct Quick {
    number: f64,
    center: Vec3,
    /// r² - |c|², with the sphere's part of E.
    constant: f64,
    /// S.
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

    /// The first sphere along each ray, and the lanes in which that is sure.
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
            // Later by the slack, so that what may be ahead is.
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
        // What is second is later by the slack, too.
        let limit = slack + slack;
        let is_sure = V::select(is_none, limit, exact + limit).lt(second) & (is_none | zero.lt(exact)) & !grazes;
        (Found { nearest: V::select(is_none, infinity, exact), primitive: number }, is_sure)
    }
}

/// The dot product, and a number.
#[inline(always)]
fn dot_and<V: Float>(a: Vec3<V>, b: Vec3<V>, number: V) -> V {
    a.x.about_times_plus(b.x, a.y.about_times_plus(b.y, a.z.about_times_plus(b.z, number)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::lanes::walks::{nearest, side_by_side, walks};
    use crate::kernel::rays::Start;
    use crate::scene::{SCENES, load};
    use crate::simd::{Mask, Precision, Work, levels, on_level};

    /// Compares the filter with a test of all; which share of the rays it was sure of.
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

    /// Whatever the filter is sure of is what the test of all spheres finds, to the bit, down to edges where two spheres are met at once; and in
    /// walks it is sure of nearly all.
    #[test]
    fn what_is_sure_is_right() {
        let mut scenes = 0;
        for (name, _) in SCENES {
            let scene = load(name).unwrap();
            if !scene.is_round() || scene.hierarchy.is_some() {
                continue;
            }
            scenes += 1;
            let (walks, edges) = walks(&scene, 20_000);
            assert!(edges.len() > 2000, "{name}: {} rays near edges", edges.len());
            for level in levels() {
                let sure = [&walks, &edges].map(|rays| on_level(level, Precision::F64, Compare(&scene, rays)));
                println!("{name} {}: sure of {sure:?}, in walks and near edges", level.name());
                assert!(sure[0] > 0.98 && sure[1] < sure[0], "{name} {}: sure of {sure:?}", level.name());
            }
        }
        assert!(scenes > 5, "{scenes} scenes of spheres");
    }
}
