//! `--accelerator sah`: every position between two centroids along every axis is tried, and the one with the least
//! expected cost is taken: `C = C_trav + (S_A / S_N) N_A C_isect + (S_B / S_N) N_B C_isect` (MacDonald and Booth,
//! "Heuristics for Ray Tracing Using Space Subdivision", 1990; report B), where S are surface areas and N numbers of
//! primitives. A node that no split makes cheaper is a leaf.
//!
//! For nodes with thousands of primitives, only the positions between 32 equal bins are tried (I. Wald, "On fast
//! Construction of SAH-based Bounding Volume Hierarchies", 2007).

use super::{Bounds, Item, Split};

/// Cost of a traversal step, in tests of a primitive (measured: a box takes about half as long as a sphere).
const TRAVERSAL: f64 = 1.0;

/// Bins on an axis.
const BINS: usize = 32;

/// The primitives of a bin: their bounding box and their number.
type Bin = (Bounds, usize);

/// The rule, with a buffer for the surface area of the primitives behind each position.
#[derive(Clone)]
pub(super) struct Sah {
    behind: Vec<f64>,
}

impl Sah {
    pub(super) fn new() -> Self {
        Self { behind: Vec::new() }
    }
}

impl Split for Sah {
    fn split(&mut self, bounds: &[Bounds], node: &Bounds, sorted: [&[u32]; 3]) -> Option<(usize, usize)> {
        let count = sorted[0].len();
        let mut best = None;
        // Multiplied by the node's surface area, so that a flat node causes no division by zero.
        let mut least = (count as f64 - TRAVERSAL) * node.half_area();
        self.behind.resize(self.behind.len().max(count), 0.0);
        for (axis, order) in sorted.iter().enumerate() {
            let mut grown = Bounds::EMPTY;
            for place in (1..count).rev() {
                grown = grown.and(&bounds[order[place] as usize]);
                self.behind[place] = grown.half_area();
            }
            let mut grown = Bounds::EMPTY;
            for place in 1..count {
                grown = grown.and(&bounds[order[place - 1] as usize]);
                let cost = grown.half_area() * place as f64 + self.behind[place] * (count - place) as f64;
                if cost < least {
                    least = cost;
                    best = Some((axis, place));
                }
            }
        }
        best
    }

    fn divide(&self, node: &Bounds, middles: &Bounds, own: &mut [Item]) -> Option<usize> {
        // On an axis without extent, positions become NaN, which the conversion to an integer turns into 0.
        let scale = [0, 1, 2].map(|axis| BINS as f64 / (middles.high[axis] - middles.low[axis]));
        let bin_of = |bounds: &Bounds, axis: usize| {
            (((bounds.middle(axis) - middles.low[axis]) * scale[axis]) as usize).min(BINS - 1)
        };
        let mut bins: [[Bin; BINS]; 3] = [[(Bounds::EMPTY, 0); BINS]; 3];
        for Item { bounds, .. } in own.iter() {
            for (axis, bins) in bins.iter_mut().enumerate() {
                let bin = &mut bins[bin_of(bounds, axis)];
                *bin = (bin.0.and(bounds), bin.1 + 1);
            }
        }
        let least = (own.len() as f64 - TRAVERSAL) * node.half_area();
        let best = bins.iter().enumerate().fold((least, None), |best, (axis, bins)| cheaper(best, axis, bins));
        let (axis, place) = best.1?;
        Some(to_front(own, |item| bin_of(&item.bounds, axis) < place))
    }
}

/// Moves the items that satisfy `is_first` to the front; returns their number.
fn to_front(own: &mut [Item], is_first: impl Fn(&Item) -> bool) -> usize {
    let mut front = 0;
    for place in 0..own.len() {
        if is_first(&own[place]) {
            own.swap(front, place);
            front += 1;
        }
    }
    front
}

/// Returns the cheaper of the best split so far and the best one before a bin of this axis: its cost and its place, an
/// axis and a bin.
fn cheaper(mut best: (f64, Option<(usize, usize)>), axis: usize, bins: &[Bin; BINS]) -> (f64, Option<(usize, usize)>) {
    let add = |(grown, number): Bin, bin: &Bin| (grown.and(&bin.0), number + bin.1);
    let mut behind = [0.0; BINS];
    let mut last = (Bounds::EMPTY, 0);
    for place in (1..BINS).rev() {
        last = add(last, &bins[place]);
        behind[place] = last.0.half_area() * last.1 as f64;
    }
    let mut first = (Bounds::EMPTY, 0);
    let count = last.1 + bins[0].1;
    for place in 1..BINS {
        first = add(first, &bins[place - 1]);
        let cost = first.0.half_area() * first.1 as f64 + behind[place];
        if (1..count).contains(&first.1) && cost < best.0 {
            best = (cost, Some((axis, place)));
        }
    }
    best
}
