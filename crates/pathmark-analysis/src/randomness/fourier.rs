//! Correlations of two square images at all lags at once, by the fast Fourier transform (Cooley and Tukey, 1965).

use std::f64::consts::TAU;

/// A square of complex numbers, row by row; its side is a power of two.
#[derive(Clone)]
pub struct Square {
    side: usize,
    values: Vec<[f64; 2]>,
}

fn times([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

/// Returns the first n / 2 powers of the n-th root of 1.
fn roots(n: usize) -> Vec<[f64; 2]> {
    let root = |k: usize| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / n as f64);
        [cos, -sin]
    };
    (0..n / 2).map(root).collect()
}

/// Transforms `line` in place; its length is a power of two.
fn transform(line: &mut [[f64; 2]], roots: &[[f64; 2]]) {
    let n = line.len();
    let bits = n.trailing_zeros();
    for index in 1..n {
        let other = index.reverse_bits() >> (usize::BITS - bits);
        if index < other {
            line.swap(index, other);
        }
    }
    let mut half = 1;
    while half < n {
        for pair in line.chunks_exact_mut(2 * half) {
            let (low, high) = pair.split_at_mut(half);
            for ((low, high), root) in low.iter_mut().zip(high).zip(roots.iter().step_by(n / (2 * half))) {
                let turned = times(*high, *root);
                *high = [low[0] - turned[0], low[1] - turned[1]];
                *low = [low[0] + turned[0], low[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

impl Square {
    /// Creates a square from `side` rows of real numbers.
    pub fn new(side: usize, values: impl Iterator<Item = f64>) -> Self {
        debug_assert!(side.is_power_of_two());
        Self { side, values: values.map(|x| [x, 0.0]).collect() }
    }

    fn transposed(self) -> Self {
        let side = self.side;
        let values = (0..side * side).map(|index| self.values[index % side * side + index / side]).collect();
        Self { side, values }
    }

    /// Returns its two-dimensional transform.
    #[must_use]
    pub fn transformed(mut self) -> Self {
        let roots = roots(self.side);
        for _ in 0..2 {
            self.values.chunks_exact_mut(self.side).for_each(|line| transform(line, &roots));
            self = self.transposed();
        }
        self
    }
}

/// Returns the sums of products of two images at every lag, from their transforms. The lags are cyclic shifts of one
/// image.
pub fn correlations(a: &Square, b: &Square) -> Vec<f64> {
    let values = a.values.iter().zip(&b.values).map(|(a, b)| times([a[0], -a[1]], *b)).collect();
    // The forward transform replaces the inverse: they differ by a factor and the sign of the lag, and lags of both
    // signs are present.
    let lags = Square { side: a.side, values }.transformed();
    let scale = 1.0 / (a.side * a.side) as f64;
    lags.values.iter().map(|value| value[0] * scale).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with sums as the definition gives them.
    #[test]
    fn sums_of_products() {
        let side = 8;
        let value = |k: usize, by: usize| (k * by % 13) as f64 - 6.0;
        let [a, b] = [5, 7].map(|by| (0..side * side).map(|k| value(k, by)).collect::<Vec<_>>());
        let found = correlations(
            &Square::new(side, a.iter().copied()).transformed(),
            &Square::new(side, b.iter().copied()).transformed(),
        );
        for (lag, found) in found.into_iter().enumerate() {
            let (dx, dy) = (lag % side, lag / side);
            let moved = |k: usize| (k % side + side - dx) % side + (k / side + side - dy) % side * side;
            let sum: f64 = (0..side * side).map(|k| a[k] * b[moved(k)]).sum();
            assert!((found - sum).abs() < 1e-9, "lag {dx}, {dy}: {found}, not {sum}");
        }
    }
}
