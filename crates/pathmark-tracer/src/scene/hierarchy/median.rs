//! `--accelerator median`: each child gets half of the primitives, along the axis of the widest spread of centroids,
//! down to one primitive per leaf.

use super::{Bounds, Item, Split};

/// The rule; it has no state.
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

    fn divide(&self, _node: &Bounds, middles: &Bounds, own: &mut [Item]) -> Option<usize> {
        let spread = |axis: usize| middles.high[axis] - middles.low[axis];
        let axis = (1..3).fold(0, |widest, axis| if spread(axis) > spread(widest) { axis } else { widest });
        let place = |item: &Item| item.bounds.middle(axis);
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |a, b| place(a).total_cmp(&place(b)).then(a.number.cmp(&b.number)));
        Some(half)
    }
}
