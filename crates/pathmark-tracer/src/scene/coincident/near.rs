//! Surfaces that are one to single precision: they are so near that its rounding decides which of them rays meet.

use super::overlap::{Flat, largest_distance, longest_edge};
use super::{Slack, spheres_in_one_place};
use crate::scene::extent::length;
use crate::scene::{Scene, Sphere, Triangle};

/// Rounding in single precision moves hits by up to about 2^-22 of the lengths of a scene.
const SINGLE: f64 = 1.0 / (1 << 20) as f64;

impl Scene {
    /// Returns the names of two objects of which single precision cannot tell which one is in front, if there are two.
    ///
    /// It compares spheres, planes, and triangles of two objects with their like, and triangles with planes.
    pub(in crate::scene) fn near_in_single_precision(&self) -> Option<[String; 2]> {
        let camera = self.camera.position.largest();
        let slack = Slack { flat: SINGLE, sphere: SINGLE, least: SINGLE * camera };
        let [of_plane, of_triangle] =
            [self.primitives.spheres.len(), self.primitives.spheres.len() + self.primitives.planes.len()];
        let owners = |one: usize, other: usize| [self.owners[one], self.owners[other]];
        let pair = self
            .near_spheres(&slack)
            .map(|(one, other)| owners(one, other))
            .or_else(|| self.near_planes(&slack).map(|(one, other)| owners(of_plane + one, of_plane + other)))
            .or_else(|| {
                let (plane, triangle) = self.triangle_near_plane(&slack)?;
                Some(owners(of_plane + plane, of_triangle + triangle))
            })
            .or_else(|| {
                let triangles = &self.primitives.triangles;
                let found = Flat::overlaps(triangles, &self.owners[of_triangle..], &slack, |_| false);
                found.first().map(|(one, other)| owners(of_triangle + one, of_triangle + other))
            });
        pair.map(|pair| pair.map(|owner| self.objects[owner as usize].name.clone()))
    }

    fn near_spheres(&self, slack: &Slack) -> Option<(usize, usize)> {
        let spheres = &self.primitives.spheres;
        let is_large = self.large_spheres();
        // The coefficients of large spheres are of the scene's size, whatever their radius.
        let large: Vec<usize> = (0..spheres.len()).filter(|sphere| is_large[*sphere]).collect();
        let size = self.size();
        let pairs = large.iter().enumerate().flat_map(|(place, one)| large[..place].iter().map(|other| (*other, *one)));
        let mut alike = pairs.filter(|(one, other)| are_one(&spheres[*one], &spheres[*other], size, slack));
        let small: Vec<usize> = (0..spheres.len()).filter(|sphere| !is_large[*sphere]).collect();
        let own: Vec<Sphere> = small.iter().map(|sphere| spheres[*sphere]).collect();
        let mut near = spheres_in_one_place(&own, slack);
        alike.next().or_else(|| near.next().map(|(one, other)| (small[one], small[other])))
    }

    fn near_planes(&self, slack: &Slack) -> Option<(usize, usize)> {
        let planes = &self.primitives.planes;
        let mut pairs = (0..planes.len()).flat_map(|one| (0..one).map(move |other| (other, one)));
        pairs.find(|(one, other)| planes[*one].is_where(&planes[*other], slack))
    }

    fn triangle_near_plane(&self, slack: &Slack) -> Option<(usize, usize)> {
        let plane = |triangle: &Triangle| {
            // The triangles of a small mesh that meets a plane may lie within rounding of it as a whole.
            let is_wide = longest_edge(triangle) > 4.0 * largest_distance(triangle, triangle, slack);
            self.primitives.planes.iter().position(|plane| is_wide && plane.holds(triangle, slack))
        };
        let mut triangles = self.primitives.triangles.iter().enumerate();
        triangles.find_map(|(index, triangle)| Some((plane(triangle)?, index)))
    }
}

/// Whether two large spheres are one: of one direction from the origin, one distance and one curvature.
fn are_one(one: &Sphere, other: &Sphere, size: f64, slack: &Slack) -> bool {
    let direction = |sphere: &Sphere| sphere.center * (1.0 / sphere.radius);
    let distance = |sphere: &Sphere| length(sphere.center) - sphere.radius;
    let curvature = |sphere: &Sphere| size / sphere.radius;
    (direction(one) - direction(other)).largest() <= slack.flat
        && (distance(one) - distance(other)).abs() <= slack.flat * size + slack.least
        && (curvature(one) - curvature(other)).abs() <= slack.flat
}
