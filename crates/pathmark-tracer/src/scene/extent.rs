//! Lengths of a scene: its size, the spheres that are large next to it, and the lengths that single precision can hold.
//!
//! The *reach* of an object is the distance from the origin to its farthest point. A scene may have a few walls a
//! thousand times as far away as everything else, so its size follows from the object of the smallest reach and from
//! the camera.

use super::{Scene, Sphere, Triangle};
use crate::error::{InputError, Result};
use crate::math::{Vec3, dot};

/// A plane has no farthest point, and an empty scene no second object. Rays are then taken to stay within this many
/// times the distance of the camera or of the nearest plane, if that is larger.
const BESIDE: f64 = 16.0;

/// Scenes of sizes from 2^-20 to 2^20 are not scaled for single precision.
const USUAL: i32 = 20;

/// The farthest point of a sphere and the distance of a plane, in sizes of the scene, up to which no square overflows
/// in single precision.
const LONGEST: f64 = (1_u64 << 40) as f64;
/// The distance of corners, and of points by which planes are given, in sizes of the scene. Beyond it rounding in
/// single precision moves near hits by a sixteenth of the scene's size.
const WIDEST: f64 = (1 << 20) as f64;
/// The smallest radius of a sphere that is not large, in sizes of the scene or distances of its centre from the origin.
/// Rounding in single precision moves rays by up to 2^-22 of these lengths, so a smaller sphere seems larger or
/// smaller: by a thousandth of its area at this radius, and by half of it at a hundredth of this radius. The same holds
/// for the extent of an object of triangles.
const FINEST: f64 = 1.0 / (1 << 17) as f64;

/// The length of a vector. If squares underflow, it is the largest coordinate.
pub(super) fn length(v: Vec3) -> f64 {
    let square = dot(v, v);
    if square.is_normal() { square.sqrt() } else { v.largest() }
}

impl Sphere {
    /// The distance from the origin to its farthest point.
    fn reach(&self) -> f64 {
        length(self.center) + self.radius
    }

    /// The distance from the origin to its nearest point.
    fn clearance(&self) -> f64 {
        (length(self.center) - self.radius).abs()
    }
}

impl Triangle {
    fn reach(&self) -> f64 {
        self.corners.iter().map(|corner| length(*corner)).fold(0.0, f64::max)
    }
}

impl Scene {
    /// The triangles of each object.
    fn meshes(&self) -> impl Iterator<Item = &[Triangle]> {
        let triangles = &self.primitives.triangles;
        let owners = &self.owners[self.owners.len() - triangles.len()..];
        // The triangles of an object follow each other.
        let mut start = 0;
        owners.chunk_by(|a, b| a == b).map(move |own| {
            start += own.len();
            &triangles[start - own.len()..start]
        })
    }

    /// Returns the smallest reach of an object that consists of triangles; infinity without triangles.
    fn reach_of_triangles(&self) -> f64 {
        let reach = |mesh: &[Triangle]| mesh.iter().map(Triangle::reach).fold(0.0, f64::max);
        self.meshes().map(reach).fold(f64::INFINITY, f64::min)
    }

    /// Returns the distance of the nearest plane from the origin, if there are planes.
    fn nearest_plane(&self) -> Option<f64> {
        let distances = self.primitives.planes.iter().map(|plane| dot(plane.point, plane.normal).abs());
        distances.reduce(f64::min)
    }

    /// Returns the scale of a scene: the camera's distance from the origin, or the smallest reach of an object, if that
    /// is larger. If there are only planes, the nearest one counts.
    pub fn size(&self) -> f64 {
        let camera = length(self.camera.position);
        let spheres = self.primitives.spheres.iter().map(Sphere::reach);
        let smallest = spheres.fold(self.reach_of_triangles(), f64::min);
        if smallest.is_finite() {
            return smallest.max(camera);
        }
        BESIDE * self.nearest_plane().unwrap_or_default().max(camera)
    }

    /// Returns for each sphere whether it is large: its radius is at least the distances of its nearest point and of
    /// the camera from the origin, and at least the smallest reach of any other object. Rays meet such a sphere where
    /// it is nearly flat.
    pub fn large_spheres(&self) -> Vec<bool> {
        let spheres = &self.primitives.spheres;
        let camera = length(self.camera.position);
        let mut rest = self.reach_of_triangles();
        let planes = self.nearest_plane();
        if planes.is_some() || (spheres.len() == 1 && rest.is_infinite()) {
            rest = rest.min(BESIDE * planes.unwrap_or_default().max(camera));
        }
        let by_reach = |a: &f64, b: &f64| a.total_cmp(b);
        let mut smallest: Vec<f64> = spheres.iter().map(Sphere::reach).collect();
        smallest.sort_unstable_by(by_reach);
        smallest.truncate(2);
        let is_large = |sphere: &Sphere| {
            let other = smallest.get(usize::from(smallest.first() == Some(&sphere.reach())));
            let others = other.copied().unwrap_or(f64::INFINITY).min(rest);
            sphere.radius >= others.max(camera).max(sphere.clearance())
        };
        spheres.iter().map(is_large).collect()
    }

    /// Checks that single precision can hold the scene's lengths, and returns the factor for them: 1, or a power of two
    /// that brings the scene's size near 1.
    pub fn factor_in_single_precision(&self) -> Result<f64> {
        let size = self.size();
        let error = |what: &str, value: f64, allowed: String| {
            let problem = format!("does not fit a scene with {what} of {value:e} and the size {size:.3e}");
            Err(InputError::new("precision", "f32", problem).allowed(allowed).into())
        };
        for (sphere, is_large) in self.primitives.spheres.iter().zip(self.large_spheres()) {
            let finest = FINEST * length(sphere.center).max(size);
            if !is_large && sphere.radius < finest {
                return error("a radius", sphere.radius, format!("f64, or radii from {finest:.3e}"));
            }
            if sphere.reach() > LONGEST * size {
                return error(
                    "a sphere up to a distance",
                    sphere.reach(),
                    format!("f64, or up to {:.3e}", LONGEST * size),
                );
            }
        }
        for plane in &self.primitives.planes {
            let (away, beside) = (dot(plane.point, plane.normal), length(plane.point));
            if away.abs() > LONGEST * size || beside > WIDEST * away.abs().max(size) {
                let allowed = format!("f64, or a point at up to {:.3e}", WIDEST * size);
                return error("a point of a plane at a distance", beside, allowed);
            }
        }
        let widest = self.primitives.triangles.iter().map(Triangle::reach).fold(0.0, f64::max);
        if widest > WIDEST * size {
            return error("a corner at a distance", widest, format!("f64, or up to {:.3e}", WIDEST * size));
        }
        for mesh in self.meshes() {
            let [first, ..] = mesh[0].corners;
            let corners = || mesh.iter().flat_map(|triangle| triangle.corners);
            let extent = corners().map(|corner| length(corner - first)).fold(0.0, f64::max);
            let finest = FINEST * corners().map(length).fold(size, f64::max);
            if extent < finest {
                return error("triangles that extend over", extent, format!("f64, or an extent from {finest:.3e}"));
            }
        }
        if let Some([one, other]) = &self.near {
            let problem = format!("cannot tell which of {one} and {other} is in front, so near are their surfaces");
            let allowed = "f64, or surfaces farther apart than 2^-20 of their coordinates and the camera's";
            return Err(InputError::new("precision", "f32", problem).allowed(allowed).into());
        }
        let (_, exponent) = libm::frexp(size);
        let is_usual = size == 0.0 || exponent.abs() <= USUAL;
        Ok(if is_usual { 1.0 } else { libm::ldexp(1.0, -exponent) })
    }
}
