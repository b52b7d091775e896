//! `--accelerator median`: half of the primitives to either side, along the axis where their centroids spread most, down to one each.

use super::{Bounds, Split};

/// The rule; it remembers nothing.
#[derive(Clone)]
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

    fn divide(&self, bounds: &[Bounds], _node: &Bounds, own: &mut [u32]) -> Option<usize> {
        let middles = own.iter().fold(Bounds::EMPTY, |middles, k| {
            let middle = [0, 1, 2].map(|axis| bounds[*k as usize].middle(axis));
            middles.and(&Bounds { low: middle, high: middle })
        });
        let spread = |axis: usize| middles.high[axis] - middles.low[axis];
        let axis = (1..3).fold(0, |widest, axis| if spread(axis) > spread(widest) { axis } else { widest });
        let place = |k: &u32| bounds[*k as usize].middle(axis);
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)).then(a.cmp(b)));
        Some(half)
    }
}
