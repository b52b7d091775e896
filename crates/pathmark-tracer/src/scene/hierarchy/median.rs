//! `--accelerator median`: half of the primitives to either side, along the axis where their centroids spread most, down to one each.

use super::{Bounds, Split};

/// The rule; it remembers nothing.
pub(super) struct Median;

impl Split for Median {
    fn split(&mut self, bounds: &[Bounds], _node: &Bounds, sorted: [&[u32]; 3]) -> Option<(usize, usize)> {
        let spread = |axis: usize| {
            let [first, last] = [sorted[axis].first()?, sorted[axis].last()?].map(|k| bounds[*k as usize].middle(axis));
            Some(last - first)
        };
        let axis = (1..3).fold(0, |widest, axis| if spread(axis) > spread(widest) { axis } else { widest });
        Some((axis, sorted[axis].len() / 2))
    }
}
