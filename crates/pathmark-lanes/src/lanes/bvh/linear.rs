//! Each primitive against the rays of all lanes at a time: for scenes with too few primitives for a hierarchy. With one
//! ray at a time, each primitive that the ray meets would cost a branch; here it costs one branch for all rays.

use super::ray_packet::{ShearedRays, three};
use crate::lanes::rays::Found;
use crate::lanes::rays::Rays;
use crate::lanes::spheres_f32::SpheresF32;
use crate::simd::{Float, Mask};
use pathmark_tracer::math::{Crossing, Vec3, first_root};
use pathmark_tracer::scene::Primitives;

/// Most corners that the triangles of a group share: the corners of a box.
const MOST_CORNERS: usize = 8;

/// The primitives of a scene, except for planes and for spheres that are tested elsewhere.
pub(super) struct Linear {
    /// Numbers, centres and radii.
    spheres: Vec<(f64, Vec3, f64)>,
    groups: Vec<Group>,
}

/// Consecutive triangles with few corners between them. Each corner is transformed to the rays' axes once.
#[derive(Default)]
struct Group {
    corners: Vec<Vec3>,
    /// Indices of a triangle's corners, and its number.
    triangles: Vec<([usize; 3], f64)>,
}

impl Group {
    /// The indices of a triangle's corners. New corners are added; `None` if there is no room.
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

impl Linear {
    pub(super) fn of(primitives: &Primitives, large: Option<&SpheresF32>) -> Self {
        let of_sphere = |(number, sphere): (u32, &pathmark_tracer::scene::Sphere)| {
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

    /// Takes nearer hits than the hits found so far, which must be on spheres and planes.
    #[inline(always)]
    pub(super) fn nearest<V: Float>(&self, rays: &Rays<V>, found: &mut Found<V>) {
        let never = V::splat(f64::NAN);
        for (number, center, radius) in &self.spheres {
            let number = V::splat(*number);
            let offset = rays.ray.origin - Vec3::splat(*center);
            let root = first_root(offset, rays.ray.direction, V::splat(1.0), V::splat(*radius));
            found.take_in_any_order(number, V::select(rays.from.equal(number), never, root));
        }
        let turned = ShearedRays::of(rays);
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
                    // Numbers rise, and spheres and planes have lower ones: the first of equally near triangles has the
                    // lowest number.
                    found.take_from_anywhere(number, V::select(is_met, crossing.root(), never));
                }
            }
        }
    }
}
