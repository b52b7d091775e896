//! `--accelerator sah`: every position between two centroids along every axis is tried, and the one with the least expected cost taken:
//! `C = C_trav + (S_A / S_N) N_A C_isect + (S_B / S_N) N_B C_isect` (MacDonald and Booth, "Heuristics for Ray Tracing Using Space
//! Subdivision", 1990; report B), where S are surfaces and N numbers of primitives. A node that no split makes cheaper is a leaf.

use super::{Bounds, Split};

/// What a step of the traversal costs in tests of a primitive (measured: a box takes about as long as half a sphere).
const TRAVERSAL: f64 = 1.0;

/// The rule, and room for the surfaces of everything behind a position.
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
        // Multiplied by the node's surface, so that a flat node divides nothing by zero.
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
}
