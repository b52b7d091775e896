//! Separable filters: products of a row and a column. Outside the plane, the nearest value inside is repeated.

/// Weights at -radius, .., radius.
pub(super) struct Kernel(Vec<f64>);

impl Kernel {
    pub(super) fn new(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        Self((0..=2 * radius).map(|k| weight(k as f64 - radius as f64)).collect())
    }

    pub(super) fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|weight| weight * factor).collect())
    }

    /// Positive weights that sum to 1, and negative ones that sum to -1.
    pub(super) fn balanced(&self) -> Self {
        let sum = |sign: f64| self.0.iter().filter(|weight| sign * **weight > 0.0).sum::<f64>();
        let (positive, negative) = (sum(1.0), -sum(-1.0));
        Self(self.0.iter().map(|weight| weight / if *weight > 0.0 { positive } else { negative }).collect())
    }
}

/// Filters a plane of rows of `width` values: by `row` along the rows, and by `column` across them. Kernels are not
/// mirrored.
pub(super) fn convolve(plane: &[f64], width: usize, row: &Kernel, column: &Kernel) -> Vec<f64> {
    let height = plane.len() / width;
    let within = |place: usize, k: usize, kernel: &Kernel, length: usize| {
        (place + k).saturating_sub(kernel.0.len() / 2).min(length - 1)
    };
    let mut rows = Vec::with_capacity(plane.len());
    for line in plane.chunks_exact(width) {
        let at =
            |x: usize| row.0.iter().enumerate().map(|(k, weight)| weight * line[within(x, k, row, width)]).sum::<f64>();
        rows.extend((0..width).map(at));
    }
    let mut out = vec![0.0; plane.len()];
    for (y, line) in out.chunks_exact_mut(width).enumerate() {
        for (k, weight) in column.0.iter().enumerate() {
            let from = within(y, k, column, height) * width;
            line.iter_mut().zip(&rows[from..from + width]).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    out
}
