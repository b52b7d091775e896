//! A ray through the tree: a loop over a stack of fixed size, nearer children first.

use super::bounds::Slabs;
use super::build::DEEPEST;
use super::{Hierarchy, Tests};
use crate::math::Ray;
use crate::scene::shape::Nearest;

impl Hierarchy {
    /// The nearest primitive, if it beats `nearest`; `distance` tests one.
    #[inline(always)]
    pub(in crate::scene) fn nearest(
        &self,
        ray: &Ray,
        mut nearest: Nearest,
        tests: &mut Tests,
        mut distance: impl FnMut(u32) -> f64,
    ) -> Nearest {
        let slabs = Slabs::new(ray, self.margin);
        let mut waiting = [0_u32; DEEPEST + 1];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let index = waiting[depth];
            let node = &self.nodes[index as usize];
            tests.boxes += 1;
            // A box exactly as far as the nearest so far is opened: a lower number wins a tie.
            if !slabs.enters(&node.bounds, nearest.t) {
                continue;
            }
            if node.count == 0 {
                let (first, second) = (index + 1, node.at);
                let (near, far) = if slabs.backward[node.axis as usize] { (second, first) } else { (first, second) };
                waiting[depth] = far;
                waiting[depth + 1] = near;
                depth += 2;
                continue;
            }
            let leaf = node.at as usize..node.at as usize + usize::from(node.count);
            tests.primitives += u64::from(node.count);
            for &primitive in &self.order[leaf] {
                nearest = nearest.or_in_any_order(distance(primitive), primitive);
            }
        }
        nearest
    }
}
