//! The Mandelbrot set: points inside cost a thousand steps, points outside few, and the two lie side by side.

use super::{Item, Workload};

/// Iterations of z² + c after which a point counts as inside.
const LIMIT: u32 = 1000;
/// The section: the whole set, with its axis of symmetry in the middle.
const LEFT: f64 = -2.0;
const WIDTH: f64 = 2.75;
const HALF_HEIGHT: f64 = 1.25;

/// Iterates z² + c until |z| > 2. Each sample takes another quarter of its pixel.
#[derive(Debug, Clone, Copy)]
pub struct Mandelbrot;

impl Workload for Mandelbrot {
    fn about(&self) -> &'static str {
        "the Mandelbrot set, at most 1000 steps a point: neighbouring points with unequal costs"
    }

    fn run(&self, item: &Item) -> [f64; 3] {
        let [dx, dy] = [item.sample % 2, item.sample / 2 % 2].map(|half| 0.25 + 0.5 * f64::from(half));
        let x = LEFT + WIDTH * (f64::from(item.x) + dx) / f64::from(item.width);
        let y = HALF_HEIGHT * (1.0 - 2.0 * (f64::from(item.y) + dy) / f64::from(item.height));
        let shade = f64::from(LIMIT - steps(x, y)) / f64::from(LIMIT);
        [shade * shade, shade, shade.sqrt()]
    }
}

/// Steps until the point x + iy has left the circle of radius 2, or the limit.
fn steps(x: f64, y: f64) -> u32 {
    let (mut re, mut im) = (0.0, 0.0);
    for step in 0..LIMIT {
        let (re2, im2) = (re * re, im * im);
        if re2 + im2 > 4.0 {
            return step;
        }
        (re, im) = (re2 - im2 + x, 2.0 * re * im + y);
    }
    LIMIT
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0, -1 and the tip at -2 are in the set. The orbit of 1 is 0, 1, 2, 5, and the orbit of 3 is 0, 3.
    #[test]
    fn steps_are_those_of_known_points() {
        assert_eq!([steps(0.0, 0.0), steps(-1.0, 0.0), steps(-2.0, 0.0)], [LIMIT; 3]);
        assert_eq!([steps(1.0, 0.0), steps(3.0, 0.0)], [3, 1]);
    }
}
