//! Triangle hits that may not be sure: the checks by [`pathmark_tracer::scene::nearness`] and by the padding of boxes, for many
//! rays at a time.

use crate::lanes::rays::Found;
use crate::lanes::rays::LanesOf;
use crate::lanes::tables::Tables;
use crate::simd::{Float, MOST_LANES, Mask};
use pathmark_tracer::math::{Ray, Vec3, dot};
use pathmark_tracer::scene::{Scene, Triangle, nearness, padding};

/// The `wanted` lanes whose hits have to be searched again.
///
/// In single precision these are only the rays that start near the plane of their triangle: the padding of boxes covers
/// the rest.
#[inline(always)]
pub(super) fn are_uncertain<V: Float>(
    scene: &Scene,
    tables: &Tables,
    ray: &Ray<V>,
    found: &Found<V>,
    wanted: u32,
) -> u32 {
    let Ray { origin, direction } = *ray;
    let [x, y, z, far] = V::rows(&tables.surfaces, found.primitive);
    let is_triangle = far.lt(V::splat(0.0)) & found.nearest.lt(V::splat(f64::INFINITY));
    let reach = origin.x.abs().larger(origin.y.abs()).larger(origin.z.abs()) - far;
    let height = found.nearest * dot(Vec3 { x, y, z }, direction).abs();
    let is_near = height.le(reach * V::splat(nearness(V::SIGNIFICAND)));
    let wanted = wanted & is_triangle.bits();
    if !V::IS_DOUBLE {
        return wanted & is_near.bits();
    }
    let slack = reach * V::splat(0.5 * padding(f64::MANTISSA_DIGITS));
    let point = ray.at(found.nearest);
    let Some([lows, highs]) = &tables.boxes else {
        return wanted & (is_near.bits() | outside(scene, point, slack, found.primitive, wanted));
    };
    let [x, y, z, _] = V::rows(lows, found.primitive);
    let below = point.x.lt(x - slack) | point.y.lt(y - slack) | point.z.lt(z - slack);
    let [x, y, z, _] = V::rows(highs, found.primitive);
    let above = (x + slack).lt(point.x) | (y + slack).lt(point.y) | (z + slack).lt(point.z);
    wanted & (is_near | below | above).bits()
}

/// The `wanted` lanes whose points are outside the boxes of their triangles, by the corners of each. Scenes of many
/// primitives have no tables of boxes, because two rows would take 64 bytes, nearly as much as the corners.
#[inline(always)]
fn outside<V: Float>(scene: &Scene, point: Vec3<V>, slack: V, triangles: V, wanted: u32) -> u32 {
    let mut rows = [[V::One::default(); MOST_LANES]; 5];
    for (row, vector) in rows.iter_mut().zip(&[point.x, point.y, point.z, slack, triangles]) {
        vector.store(row);
    }
    let mut outside = 0;
    for lane in LanesOf(wanted) {
        let [x, y, z, slack, number] = rows.each_ref().map(|row| row[lane].into());
        let Some(Triangle { corners: [a, b, c] }) = scene.primitives.triangle(number as u32) else { continue };
        let is_outside = is_beside(x, [a.x, b.x, c.x], slack)
            | is_beside(y, [a.y, b.y, c.y], slack)
            | is_beside(z, [a.z, b.z, c.z], slack);
        outside |= u32::from(is_outside) << lane;
    }
    outside
}

/// Whether a coordinate is outside the range of three others, widened by some slack.
#[inline(always)]
fn is_beside(x: f64, [a, b, c]: [f64; 3], slack: f64) -> bool {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    let (low, high) = (if c < low { c } else { low }, if high < c { c } else { high });
    x < low - slack || high + slack < x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::tests::{nearest, side_by_side, walks};
    use crate::simd::{Level, Precision, Work, levels, on_level};
    use pathmark_tracer::kernel::Start;
    use pathmark_tracer::scene::load;

    /// Counts the lanes in doubt, with another triangle at the same distance in every other lane.
    struct InDoubt<'a>(&'a Scene, &'a [Tables; 2], &'a [Start]);

    impl Work for InDoubt<'_> {
        type Output = u32;

        #[inline(always)]
        fn run<V: Float>(self) -> u32 {
            let Self(scene, tables, starts) = self;
            let mut in_doubt = 0;
            for starts in starts.chunks_exact(V::LANES) {
                let rays = side_by_side::<V>(scene, starts);
                let mut found = Found::<V>::nothing();
                for (lane, start) in starts.iter().enumerate() {
                    let (t, primitive) = nearest(scene, start);
                    found.nearest.set_lane(lane, t);
                    // Every other lane has the right triangle.
                    found.primitive.set_lane(lane, (primitive + 7.0 * (lane % 2) as f64) % scene.owners.len() as f64);
                }
                let wanted = u32::MAX >> (MOST_LANES - V::LANES);
                let [by_rows, by_corners] =
                    tables.each_ref().map(|tables| are_uncertain(scene, tables, &rays.ray, &found, wanted));
                assert_eq!(by_rows, by_corners);
                in_doubt += by_rows.count_ones();
            }
            in_doubt
        }
    }

    /// Boxes from corners give the same answers as boxes from tables.
    #[test]
    fn boxes_are_the_same_by_corners() {
        let scene = load("bumpy-ball").unwrap().accelerated("sah").unwrap();
        let (starts, _) = walks(&scene, 4000);
        let mut tables = [Precision::F64; 2].map(|precision| Tables::of(&scene, precision));
        assert!(tables[1].boxes.take().is_some());
        for level in levels() {
            let in_doubt = on_level(level, Precision::F64, InDoubt(&scene, &tables, &starts));
            assert!((50..2000).contains(&in_doubt), "{}: {in_doubt}", Level::name(level));
        }
    }
}
