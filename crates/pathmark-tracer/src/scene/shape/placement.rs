//! The placement of a mesh in its scene: its vertices are scaled, then rotated, then moved.
//!
//! ```toml
//! shape = { mesh = { file = "box.obj", scale = 0.5, rotate = [0.0, 90.0, 0.0], translate = [1.0, 0.0, 0.0] } }
//! ```
//!
//! `rotate` has three angles in degrees: about the x axis, then about the y axis, then about the z axis of the scene. A
//! positive angle turns counterclockwise for an eye that looks from the axis's positive end to the origin.

use crate::math::Vec3;

/// Sine and cosine of an angle in degrees, exact for multiples of 90.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let (sin, cos) = libm::sincos((degrees - 90.0 * quarters).to_radians());
    match (quarters as i64).rem_euclid(4) {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Returns the function that places a vertex, by a factor of every length, angles in degrees, and the place of the file's
/// origin.
pub(super) fn placing(scale: f64, rotate: [f64; 3], translate: Vec3) -> impl Fn(Vec3) -> Vec3 {
    let [about_x, about_y, about_z] = rotate.map(sin_cos);
    let turn = |(sin, cos): (f64, f64), [a, b]: [f64; 2]| [cos * a - sin * b, sin * a + cos * b];
    move |vertex| {
        let Vec3 { x, y, z } = vertex * scale;
        let [y, z] = turn(about_x, [y, z]);
        let [z, x] = turn(about_y, [z, x]);
        let [x, y] = turn(about_z, [x, y]);
        Vec3::new(x, y, z) + translate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(scale: f64, rotate: [f64; 3], translate: [f64; 3], vertex: [f64; 3]) -> [f64; 3] {
        let Vec3 { x, y, z } = placing(scale, rotate, translate.into())(vertex.into());
        [x, y, z]
    }

    const ZERO: [f64; 3] = [0.0; 3];

    /// Quarter turns are exact: each axis turns the next one into the one after it.
    #[test]
    fn vertices_are_scaled_then_rotated_then_moved() {
        let vertex = [1.0, 2.0, 3.0];
        assert_eq!(placed(0.5, ZERO, ZERO, vertex), [0.5, 1.0, 1.5]);
        let turns = [
            ([90.0, 0.0, 0.0], [1.0, -3.0, 2.0]),
            ([0.0, 90.0, 0.0], [3.0, 2.0, -1.0]),
            ([0.0, 0.0, 90.0], [-2.0, 1.0, 3.0]),
            ([0.0, 0.0, -90.0], [2.0, -1.0, 3.0]),
            ([180.0, 0.0, 0.0], [1.0, -2.0, -3.0]),
            ([0.0, 0.0, 360.0], vertex),
            // About x first: (1, 2, 3) becomes (1, -3, 2), then (2, -3, -1).
            ([90.0, 90.0, 0.0], [2.0, -3.0, -1.0]),
            ([180.0, 0.0, -270.0], [2.0, 1.0, -3.0]),
        ];
        for (rotate, expected) in turns {
            assert_eq!(placed(1.0, rotate, ZERO, vertex), expected, "{rotate:?}");
        }
        assert_eq!(placed(10.0, [0.0, 0.0, 90.0], [5.0, 0.0, -1.0], vertex), [-15.0, 10.0, 29.0]);
    }

    /// The sine of 30 degrees is 1/2, its cosine the root of 3/4.
    #[test]
    fn angles_are_degrees() {
        let [x, y, z] = placed(1.0, [0.0, 0.0, 30.0], ZERO, [2.0, 0.0, 7.0]);
        assert!((x - 3.0_f64.sqrt()).abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && z == 7.0, "{x} {y} {z}");
    }
}
