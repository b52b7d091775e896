//! Every primitive against the rays of all lanes at a time: for scenes with too few primitives for a hierarchy. One ray at a time would have a
//! branch for each primitive that it meets; here a primitive has one for all rays together.

use super::three;
use crate::kernel::lanes::nearest::Found;
use crate::kernel::lanes::packet::Rays;
use crate::kernel::lanes::singles::Singles;
use crate::math::{Crossing, Vec3, first_root, sheared};
use crate::scene::Primitives;
use crate::simd::{Float, MOST_LANES, Mask};

/// The corners that triangles of a group share at most: those of a box.
const MOST_CORNERS: usize = 8;

/// The primitives of a scene, but for planes and for what is tested elsewhere.
pub(super) struct All {
    /// Numbers, centres and radii.
    spheres: Vec<(f64, Vec3, f64)>,
    groups: Vec<Group>,
}

/// Triangles that stand one after the other and have few corners between them, each of which is turned to the rays once.
#[derive(Default)]
struct Group {
    corners: Vec<Vec3>,
    /// The places of a triangle's corners, and its number.
    triangles: Vec<([usize; 3], f64)>,
}

impl Group {
    /// The places of a triangle's corners, which are added where they are new; `None` if there is no room.
    fn places(&mut self, triangle: &[Vec3; 3]) -> Option<[usize; 3]> {
        let bits = |corner: &Vec3| [corner.x, corner.y, corner.z].map(f64::to_bits);
        let mut corners = self.corners.clone();
        let places = triangle.each_ref().map(|corner| {
            corners.iter().position(|other| bits(other) == bits(corner)).unwrap_or_else(|| {
                corners.push(*corner);
                corners.len() - 1
            })
        });
        (corners.len() <= MOST_CORNERS).then(|| {
            self.corners = corners;
            places
        })
    }
}

impl All {
    pub(super) fn of(primitives: &Primitives, large: Option<&Singles>) -> Self {
        let of_sphere = |(number, sphere): (u32, &crate::scene::Sphere)| {
            let is_here = !large.is_some_and(|large| large.contains(number));
            is_here.then_some((f64::from(number), sphere.center, sphere.radius))
        };
        let spheres = (0..).zip(&primitives.spheres).filter_map(of_sphere).collect();
        let first_triangle = (primitives.spheres.len() + primitives.planes.len()) as u32;
        let mut groups = Vec::new();
        let mut group = Group::default();
        for (number, triangle) in (first_triangle..).map(f64::from).zip(&primitives.triangles) {
            let places = group.places(&triangle.corners).unwrap_or_else(|| {
                groups.push(std::mem::take(&mut group));
                group.places(&triangle.corners).unwrap_or_default()
            });
            group.triangles.push((places, number));
        }
        groups.push(group);
        Self { spheres, groups }
    }

    /// Takes what comes before what has been found so far, which must be of spheres and planes.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(&self, rays: &Rays<V>, found: &mut Found<V>) {
        let never = V::splat(f64::NAN);
        for (number, center, radius) in &self.spheres {
            let number = V::splat(*number);
            let offset = rays.ray.origin - Vec3::splat(*center);
            let root = first_root(offset, rays.ray.direction, V::splat(1.0), V::splat(*radius));
            found.take_in_any_order(number, V::select(rays.from.equal(number), never, root));
        }
        let turned = AllTurned::of(rays);
        let mut corners = [three([0.0; 3]); MOST_CORNERS];
        for group in &self.groups {
            for (corner, place) in group.corners.iter().zip(&mut corners) {
                *place = turned.corner(*corner);
            }
            for ([a, b, c], number) in &group.triangles {
                let number = V::splat(*number);
                let crossing =
                    Crossing::of([corners[a % MOST_CORNERS], corners[b % MOST_CORNERS], corners[c % MOST_CORNERS]]);
                let is_met = crossing.is_met & !rays.from.equal(number);
                if is_met.any() {
                    // Numbers rise, and those of spheres and planes are lower: the first of equally near triangles has the lowest.
                    found.take_from_anywhere(number, V::select(is_met, crossing.root(), never));
                }
            }
        }
    }
}

/// Rays by their own axes: [`crate::math::Shear`] in lanes.
pub(super) struct AllTurned<V: Float> {
    origin: Vec3<V>,
    /// Whether the direction's longest component is x, or y.
    pub(super) is_long: [V::Mask; 2],
    pub(super) by: [V; 3],
}

impl<V: Float> AllTurned<V> {
    #[inline(always)]
    pub(super) fn of(rays: &Rays<V>) -> Self {
        let Vec3 { x, y, z } = rays.ray.direction;
        let is_x = y.abs().lt(x.abs()) & z.abs().lt(x.abs());
        let is_y = !is_x & z.abs().lt(y.abs());
        let mut turned = Self { origin: rays.ray.origin, is_long: [is_x, is_y], by: three([0.0; 3]) };
        let [x, y, z] = turned.axes(rays.ray.direction);
        turned.by = if V::IS_DOUBLE {
            let inverse = V::splat(1.0) / z;
            [x * inverse, y * inverse, inverse]
        } else {
            in_double([x, y, z])
        };
        turned
    }

    /// The components of a vector by the ray's axes.
    #[inline(always)]
    pub(super) fn axes(&self, Vec3 { x, y, z }: Vec3<V>) -> [V; 3] {
        let [is_x, is_y] = self.is_long;
        [
            V::select(is_x, y, V::select(is_y, z, x)),
            V::select(is_x, z, V::select(is_y, x, y)),
            V::select(is_x, x, V::select(is_y, y, z)),
        ]
    }

    #[inline(always)]
    fn corner(&self, corner: Vec3) -> [V; 3] {
        sheared(self.axes(Vec3::splat(corner) - self.origin), self.by)
    }
}

/// [`crate::math::Shear::by`] of directions by their own axes, rounded to single precision once, as it is for one ray.
#[inline(always)]
fn in_double<V: Float>(direction: [V; 3]) -> [V; 3] {
    let mut rows = [[V::One::default(); MOST_LANES]; 3];
    for (row, vector) in rows.iter_mut().zip(direction) {
        vector.store(row);
    }
    for lane in 0..V::LANES {
        let inverse = 1.0 / rows[2][lane].into();
        let by = |row: &[V::One; MOST_LANES]| V::one(row[lane].into() * inverse);
        [rows[0][lane], rows[1][lane], rows[2][lane]] = [by(&rows[0]), by(&rows[1]), V::one(inverse)];
    }
    [V::load(&rows[0]), V::load(&rows[1]), V::load(&rows[2])]
}
