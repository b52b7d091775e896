//! Weighted least squares for the linear forms of the laws.

use super::Law;
use crate::mean::Moments;

/// The left side of a law's linear form for a speedup: p / S - 1 or p - S.
pub(super) fn lost(law: Law, workers: f64, speedup: f64) -> f64 {
    match law {
        Law::Gustafson => workers - speedup,
        Law::Amdahl | Law::Universal => workers / speedup - 1.0,
    }
}

/// The right side for given parameters.
pub(super) fn predicted(law: Law, [first, second]: [f64; 2], workers: f64) -> f64 {
    let pairs = if law == Law::Universal { workers * (workers - 1.0) } else { 0.0 };
    first * (workers - 1.0) + second * pairs
}

/// The weight of a squared residual at this p. Errors are proportional to S, so the errors of p / S and of S are
/// proportional to their means.
pub(super) fn weight(law: Law, workers: f64, mean_lost: f64) -> f64 {
    let size = match law {
        Law::Gustafson => workers - mean_lost,
        Law::Amdahl | Law::Universal => 1.0 + mean_lost,
    };
    1.0 / (size * size)
}

/// The parameters that minimise the weighted sum of squares, in the order of [`Law::parameters`]; the second is 0 for a
/// law with one.
///
/// The normal equations are solved after the second regressor has been made orthogonal to the first; `None` if they are
/// parallel.
pub(super) fn parameters(law: Law, workers: &[f64], groups: &[Vec<f64>]) -> Option<[f64; 2]> {
    let mut rows = Vec::with_capacity(workers.len());
    for (&p, group) in workers.iter().zip(groups) {
        let each: Vec<f64> = group.iter().map(|&speedup| lost(law, p, speedup)).collect();
        let mean = Moments::of(&each).mean()?;
        // Only the mean of a group matters: the scatter around it adds the same to every sum of squares.
        rows.push((weight(law, p, mean) * group.len() as f64, p - 1.0, p * (p - 1.0), mean));
    }
    let sum = |term: &dyn Fn(f64, f64, f64) -> f64| rows.iter().map(|&(w, a, b, y)| w * term(a, b, y)).sum::<f64>();
    let (aa, ay) = (sum(&|a, _, _| a * a), sum(&|a, _, y| a * y));
    if law != Law::Universal {
        return finite([ay / aa, 0.0]);
    }
    let share = sum(&|a, b, _| a * b) / aa;
    let rest = |a: f64, b: f64| b - share * a;
    let (rr, ry) = (sum(&|a, b, _| rest(a, b) * rest(a, b)), sum(&|a, b, y| rest(a, b) * y));
    let second = ry / rr;
    finite([ay / aa - share * second, second])
}

fn finite(parameters: [f64; 2]) -> Option<[f64; 2]> {
    parameters.iter().all(|value| value.is_finite()).then_some(parameters)
}
