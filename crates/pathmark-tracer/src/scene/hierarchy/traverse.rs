//! Traversal of the tree by a ray: a loop over a stack of fixed size, nearer children first.

use super::bounds::Slabs;
use super::build::DEEPEST;
use super::{Hierarchy, Tests};
use crate::math::Ray;
use crate::scene::shape::Nearest;

/// A stack of nodes that are visited later, with the distances at which the ray enters their boxes.
struct Waiting {
    nodes: [u32; DEEPEST],
    distances: [f64; DEEPEST],
    count: usize,
}

impl Waiting {
    #[inline(always)]
    fn push(&mut self, node: u32, distance: f64) {
        self.nodes[self.count] = node;
        self.distances[self.count] = distance;
        self.count += 1;
    }

    /// Returns the last node whose box begins no farther than `limit`. At exactly the distance of the nearest hit so
    /// far, a lower number may win the tie.
    #[inline(always)]
    fn pop(&mut self, limit: f64) -> Option<u32> {
        while self.count > 0 {
            self.count -= 1;
            if self.distances[self.count] <= limit {
                return Some(self.nodes[self.count]);
            }
        }
        None
    }
}

impl Hierarchy {
    /// Returns the nearest primitive, or `nearest` if none beats it; `distance` tests a primitive.
    #[inline(always)]
    pub(in crate::scene) fn nearest(
        &self,
        ray: &Ray,
        mut nearest: Nearest,
        tests: &mut Tests,
        mut distance: impl FnMut(u32) -> f64,
    ) -> Nearest {
        let slabs = Slabs::new(ray);
        // At most one node waits for each level above the current one.
        let mut waiting = Waiting { nodes: [0; DEEPEST], distances: [0.0; DEEPEST], count: 0 };
        tests.boxes += 1;
        let mut next = slabs.enter(&self.nodes[0].faces, nearest.t).map(|_| 0);
        while let Some(index) = next {
            let node = &self.nodes[index as usize];
            if node.count == 0 {
                tests.boxes += 2;
                let (first, second) = (node.at, node.at + 1);
                // Written out: as a closure, each box test is a call that saves and restores all state of the loop.
                let a = slabs.enter(&self.nodes[first as usize].faces, nearest.t);
                let b = slabs.enter(&self.nodes[second as usize].faces, nearest.t);
                next = match (a, b) {
                    (Some(a), Some(b)) if b < a => {
                        waiting.push(first, a);
                        Some(second)
                    }
                    (Some(_), Some(b)) => {
                        waiting.push(second, b);
                        Some(first)
                    }
                    (Some(_), None) => Some(first),
                    (None, Some(_)) => Some(second),
                    (None, None) => waiting.pop(nearest.t),
                };
                continue;
            }
            let leaf = node.at as usize..node.at as usize + node.count as usize;
            tests.primitives += u64::from(node.count);
            for &primitive in &self.order[leaf] {
                nearest = nearest.or_in_any_order(distance(primitive), primitive);
            }
            next = waiting.pop(nearest.t);
        }
        nearest
    }
}
