//! Adaptive integrals over a rectangle.

/// Nodes and weights of the three-point Gauss-Legendre rule on [0, 1].
const NODES: [(f64, f64); 3] =
    [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// Minimum and maximum depth of subdivision.
const DEPTH: (u32, u32) = (1, 12);

/// The integral of `f` over a rectangle. A part is quartered until quartering changes its integral by at most the
/// tolerance.
pub(super) fn integral(x: [f64; 2], y: [f64; 2], tolerance: f64, f: &impl Fn(f64, f64) -> f64) -> f64 {
    refined(x, y, rule(x, y, f), tolerance, 0, f)
}

fn rule([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], f: &impl Fn(f64, f64) -> f64) -> f64 {
    let mut sum = 0.0;
    for (u, weight_u) in NODES {
        for (v, weight_v) in NODES {
            sum += weight_u * weight_v * f(x0 + u * (x1 - x0), y0 + v * (y1 - y0));
        }
    }
    sum * (x1 - x0) * (y1 - y0)
}

fn refined(
    [x0, x1]: [f64; 2],
    [y0, y1]: [f64; 2],
    whole: f64,
    tolerance: f64,
    depth: u32,
    f: &impl Fn(f64, f64) -> f64,
) -> f64 {
    let (x, y) = (0.5 * (x0 + x1), 0.5 * (y0 + y1));
    let quarters = [([x0, x], [y0, y]), ([x, x1], [y0, y]), ([x0, x], [y, y1]), ([x, x1], [y, y1])];
    let parts = quarters.map(|(x, y)| rule(x, y, f));
    let sum: f64 = parts.iter().sum();
    if depth >= DEPTH.1 || (depth >= DEPTH.0 && (sum - whole).abs() <= tolerance) {
        return sum;
    }
    quarters.into_iter().zip(parts).map(|((x, y), part)| refined(x, y, part, 0.5 * tolerance, depth + 1, f)).sum()
}
