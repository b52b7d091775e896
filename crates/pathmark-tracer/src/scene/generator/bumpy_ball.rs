//! A ball with bumps, of about the requested number of triangles: a mesh like those of researchers, in any size.
//!
//! Its surface is cut along m - 1 parallels and 2 m meridians into 4 m (m - 1) triangles, with the smallest m that
//! gives at least the requested number.

use super::Made;
use crate::material::{Diffuse, Material};
use crate::math::{Rgb, Vec3};
use crate::scene::Triangle;
use crate::scene::shape::AnyShape;
use serde::Deserialize;
use std::f64::consts::PI;

const RADIUS: f64 = 0.6;
/// Height of the bumps divided by the radius.
const BUMPS: f64 = 0.08;

/// The generator as scene files write it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::scene) struct BumpyBall {
    /// The least number of triangles: the number behind the scene's name.
    pub(super) triangles: u32,
}

impl BumpyBall {
    /// Bands between the parallels.
    fn bands(&self) -> u32 {
        (0.5 + 0.5 * (1.0 + f64::from(self.triangles)).sqrt()).ceil() as u32
    }
}

/// Returns the point `i` of `bands` parts down from the upper pole and `j` of twice as many parts around.
fn point(bands: u32, i: u32, j: u32) -> Vec3 {
    let part = PI / f64::from(bands);
    let (down, around) = (part * f64::from(i), part * f64::from(j % (2 * bands)));
    // The poles are points, although rounding makes the sine of half a turn nonzero.
    let ring = if i == 0 || i == bands { 0.0 } else { libm::sin(down) };
    let radius = RADIUS * (1.0 + BUMPS * ring * libm::sin(9.0 * down) * libm::sin(8.0 * around));
    Vec3::new(ring * libm::cos(around), libm::cos(down), ring * libm::sin(around)) * radius
}

impl BumpyBall {
    pub(super) fn make(&self) -> Vec<Made> {
        let bands = self.bands();
        let mut shapes = Vec::with_capacity(4 * bands as usize * (bands as usize - 1));
        for i in 0..bands {
            for j in 0..2 * bands {
                let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| point(bands, i, j));
                // Seen from outside, the corners run counterclockwise. At the poles, two of the four coincide.
                if i + 1 < bands {
                    shapes.push(AnyShape::Triangle(Triangle { corners: [a, c, b] }));
                }
                if i > 0 {
                    shapes.push(AnyShape::Triangle(Triangle { corners: [a, d, c] }));
                }
            }
        }
        let material = Material::Diffuse(Diffuse { albedo: Rgb { r: 0.6, g: 0.65, b: 0.7 } });
        vec![Made { name: "ball".to_string(), shapes, material, emission: Rgb::BLACK }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dot;

    /// The surface is closed, with every normal outwards: the divergence theorem gives the volume of the ball. Bumps
    /// and dents add 3 h^2 <f^2>, some half a percent, and flat triangles remove as much.
    #[test]
    fn it_is_a_closed_ball() {
        for (wanted, made) in [(8, 8), (9, 24), (20_000, 20_448), (20_448, 20_448)] {
            let ball = BumpyBall { triangles: wanted };
            let objects = ball.make();
            assert_eq!(objects[0].shapes.len(), made, "{wanted}");
            let mut volume = 0.0;
            for shape in &objects[0].shapes {
                let AnyShape::Triangle(triangle) = shape else { panic!("a triangle") };
                assert!(!triangle.is_degenerate(), "{triangle:?}");
                let [a, b, c] = triangle.corners;
                volume += dot(a, b.cross(c)) / 6.0;
            }
            let smooth = 4.0 / 3.0 * PI * RADIUS * RADIUS * RADIUS;
            if wanted > 10_000 {
                assert!((0.99..1.01).contains(&(volume / smooth)), "{volume} of {smooth}");
            }
            assert!(volume > 0.0, "{wanted}");
        }
    }
}
