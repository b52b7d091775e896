//! Polygons of any number of corners, cut into triangles.
//!
//! The diagonals from the first corner cut a convex polygon. A polygon that they leave is cut by ear clipping (crate
//! `earcut`, after mapbox/earcut) in the coordinate plane that it faces most. The normal is M. Newell's: the sum of the
//! vector products of neighbouring corners (Sutherland, Sproull and Schumacker, "A Characterization of Ten
//! Hidden-Surface Algorithms", 1974).

use crate::math::{Vec3, dot};
use earcut::Earcut;

/// Most corners of a face: ear clipping takes up to the square of their number.
pub(super) const MOST_CORNERS: usize = 1 << 12;

/// Corners farther than this from a common plane, as a share of the polygon's extent, make it bent: its shape then
/// depends on the cut.
const FLAT: f64 = 0.01;

/// A turn below this, as the sine of its angle, is rounding error: the corners lie on a line.
const STRAIGHT: f64 = 1e-9;

/// The relative difference between the area of the triangles and the polygon's that rounding may cause.
const SAME_AREA: f64 = 1e-6;

/// Cuts polygons and counts those that have no certain shape.
#[derive(Default)]
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    indices: Vec<u32>,
    relative: Vec<Vec3>,
    /// Polygons whose corners lie in no plane.
    bent: usize,
    /// Polygons with edges that cross.
    crossed: usize,
}

fn length(v: Vec3) -> f64 {
    dot(v, v).sqrt()
}

/// Twice the area of a triangle in the plane; negative if its corners run clockwise.
fn twice_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Drops the coordinate in which the normal is longest; the others keep the sense of rotation if it is positive there.
fn project(normal: Vec3) -> (fn(Vec3) -> [f64; 2], f64) {
    let size = normal.largest();
    if normal.z.abs() == size {
        (|v| [v.x, v.y], normal.z)
    } else if normal.y.abs() == size {
        (|v| [v.z, v.x], normal.y)
    } else {
        (|v| [v.y, v.z], normal.x)
    }
}

impl Cutter {
    /// Cuts a polygon of three or more corners and passes its triangles on; they have its sense of rotation.
    pub(super) fn cut(&mut self, corners: &[Vec3], mut add: impl FnMut([Vec3; 3])) {
        if let [a, b, c] = *corners {
            return add([a, b, c]);
        }
        if self.is_cut_from_its_first(corners) {
            for pair in corners[1..].windows(2) {
                add([corners[0], pair[0], pair[1]]);
            }
            return;
        }
        for triangle in self.indices.chunks_exact(3) {
            add([triangle[0], triangle[1], triangle[2]].map(|index| corners[index as usize]));
        }
    }

    /// Whether the diagonals from the first corner are inside the polygon. If not, `indices` has the triangles.
    fn is_cut_from_its_first(&mut self, corners: &[Vec3]) -> bool {
        // Relative to the first corner and to the extent, so that no size over- or underflows.
        let extent = corners.iter().map(|corner| (*corner - corners[0]).largest()).fold(0.0, f64::max);
        self.relative.clear();
        self.relative.extend(corners.iter().map(|corner| {
            let Vec3 { x, y, z } = *corner - corners[0];
            Vec3::new(x / extent, y / extent, z / extent)
        }));
        let pairs = || self.relative.windows(2).map(|pair| (pair[0], pair[1]));
        let (normal, sizes) = pairs().fold((Vec3::new(0.0, 0.0, 0.0), 0.0), |(sum, sizes), (a, b)| {
            let cross = a.cross(b);
            (sum + cross, sizes + length(cross))
        });
        // All corners in one point, or edges around equal areas on both sides.
        if sizes.is_nan() || length(normal) <= STRAIGHT * sizes {
            self.crossed += usize::from(pairs().any(|(a, b)| length(a.cross(b)) > STRAIGHT * length(a) * length(b)));
            return true;
        }
        let unit = normal.normalized();
        let heights = || self.relative.iter().map(|corner| dot(*corner, unit));
        self.bent += usize::from(heights().fold(0.0, f64::max) - heights().fold(0.0, f64::min) > FLAT);
        if pairs().all(|(a, b)| dot(a.cross(b), unit) >= -STRAIGHT * length(a) * length(b)) {
            return true;
        }
        let (place, twice) = project(normal);
        self.flat.clear();
        self.flat.extend(self.relative.iter().map(|corner| place(*corner)));
        self.earcut.earcut_slice(&self.flat, &[], &mut self.indices);
        let mut all = 0.0;
        for triangle in self.indices.chunks_exact_mut(3) {
            let area = twice_area([triangle[0], triangle[1], triangle[2]].map(|index| self.flat[index as usize]));
            if area * twice < 0.0 {
                triangle.swap(1, 2);
            }
            all += area.abs();
        }
        self.crossed += usize::from((all - twice.abs()).abs() > SAME_AREA * twice.abs());
        false
    }

    /// The doubts about the polygons so far, for the user.
    pub(super) fn doubts(&self) -> impl Iterator<Item = String> {
        let told = [
            (self.bent, "faces that are not flat", "the cut into triangles decides their shape"),
            (self.crossed, "faces whose edges cross", "their area is uncertain"),
        ];
        let found = told.into_iter().filter(|(count, ..)| *count > 0);
        found.map(|(count, what, effect)| format!("{what}: {count}; {effect}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Cut = (Vec<[Vec3; 3]>, Vec<String>);

    fn cut(corners: &[Vec3]) -> Cut {
        let (mut cutter, mut found) = (Cutter::default(), Vec::new());
        cutter.cut(corners, |triangle| found.push(triangle));
        (found, cutter.doubts().collect())
    }

    /// The sum of the triangles' normals, each as long as the triangle's area, and the sum of their areas.
    fn areas(triangles: &[[Vec3; 3]]) -> (Vec3, f64) {
        let normal = |[a, b, c]: &[Vec3; 3]| (*b - *a).cross(*c - *a) * 0.5;
        let zero = Vec3::new(0.0, 0.0, 0.0);
        triangles.iter().map(normal).fold((zero, 0.0), |(sum, area), normal| (sum + normal, area + length(normal)))
    }

    /// A polygon in a tilted plane: an exact turn by the angle of 3-4-5, then a shift.
    fn tilted(outline: &[[f64; 2]]) -> Vec<Vec3> {
        outline.iter().map(|[x, y]| Vec3::new(*x + 8.0, 0.6 * y - 4.0, 0.8 * y + 2.0)).collect()
    }

    /// Twice the signed area of a polygon: the shoelace formula (A. L. F. Meister, 1769).
    fn shoelace(outline: &[[f64; 2]]) -> f64 {
        let next = outline.iter().cycle().skip(1);
        outline.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
    }

    const DART: [[f64; 2]; 4] = [[-2.0, -1.0], [0.0, 0.0], [2.0, -1.0], [0.0, 2.0]];
    const COMB: [[f64; 2]; 9] =
        [[0.0, 0.0], [9.0, 0.0], [9.0, 5.0], [7.0, 1.0], [6.0, 5.0], [5.0, 1.0], [4.0, 5.0], [2.0, 1.0], [0.0, 5.0]];

    /// Wherever the list begins and whichever way it runs, the triangles cover the area once and face one way.
    #[test]
    fn concave_polygons_have_their_area() {
        assert_eq!(shoelace(&DART), 8.0);
        for outline in [&DART[..], &COMB] {
            for first in 0..outline.len() {
                for is_reversed in [false, true] {
                    let mut outline = outline.to_vec();
                    outline.rotate_left(first);
                    if is_reversed {
                        outline.reverse();
                    }
                    let (triangles, doubts) = cut(&tilted(&outline));
                    let (normal, area) = areas(&triangles);
                    let expected = shoelace(&outline) / 2.0;
                    assert!((area - expected.abs()).abs() < 1e-12, "{outline:?}: {area}");
                    assert!((normal.z - 0.6 * expected).abs() < 1e-12, "{outline:?}: {normal:?}");
                    assert!((normal.y + 0.8 * expected).abs() < 1e-12, "{outline:?}: {normal:?}");
                    assert_eq!(doubts, [""; 0]);
                }
            }
        }
    }

    /// Convex polygons are cut from their first corner, also with corners on an edge, and at any size.
    #[test]
    fn convex_polygons_are_cut_from_their_first_corner() {
        let outline = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [1.5, 2.5], [0.0, 2.0], [0.0, 1.0]];
        for size in [1.0, 1e-90, 1e-200, 1e99] {
            let corners = tilted(&outline).iter().map(|corner| *corner * size).collect::<Vec<_>>();
            let fan: Vec<_> = corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]).collect();
            assert_eq!(cut(&corners), (fan, Vec::new()), "{size}");
        }
    }

    #[test]
    fn polygons_of_uncertain_shape_are_counted() {
        let bent = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.1], [0.0, 1.0, 0.0]].map(Vec3::from);
        assert_eq!(cut(&bent).1, ["faces that are not flat: 1; the cut into triangles decides their shape"]);
        let nearly = bent.map(|corner| Vec3::new(corner.x, corner.y, 1e-3 * corner.z));
        assert_eq!(cut(&nearly).1, [""; 0]);
        // Two equal halves around a crossing, and a star of five points.
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
        let star = [[0.0, 3.0], [2.0, -3.0], [-3.0, 1.0], [3.0, 1.0], [-2.0, -3.0]];
        for outline in [&bow[..], &star] {
            assert_eq!(cut(&tilted(outline)).1, ["faces whose edges cross: 1; their area is uncertain"]);
        }
        // A line and a point have no area to doubt.
        let line = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.5, 0.0]];
        for outline in [line, [[1.0, 1.0]; 4]] {
            assert_eq!(cut(&tilted(&outline)).1, [""; 0]);
        }
    }
}
