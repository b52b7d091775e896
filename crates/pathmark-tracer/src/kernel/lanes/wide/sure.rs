//! The search for hits that are sure, along one ray by itself: where what the rays of a packet found may be rounding alone.

use super::tree::{IS_LEAF, PLACES, Tree};
use super::{Search, Wide};
use crate::kernel::lanes::singles::Singles;
use crate::math::Ray;
use crate::scene::{Nearest, Scene, Slabs, Standpoint, Tests};

impl Wide {
    /// What [`Scene::nearest`] finds, by the tree of the lanes. Its boxes have a padding for single precision and are tested in double precision, so they
    /// are left out no sooner than those of the scene's own tree would be.
    #[cold]
    #[inline(never)]
    pub(in crate::kernel::lanes) fn surely_nearest(
        &self,
        scene: &Scene,
        ray: &Ray,
        from: Option<Standpoint>,
        digits: u32,
        tests: &mut Tests,
    ) -> Nearest {
        let Search::Tree(tree) = &self.search else { return scene.nearest(ray, from, digits, tests) };
        let distance = scene.primitives.sure_distances(ray, from, digits);
        let take = |nearest: Nearest, number: u32| nearest.or_in_any_order(distance(number), number);
        let planes = self.planes.iter().map(|(number, _)| *number as u32);
        let beside = self.large.iter().flat_map(Singles::numbers).chain(planes);
        let mut nearest = beside.fold(Nearest::than(f64::INFINITY), take);

        let scale = self.blocks.scale.0;
        let slabs = Slabs::new(&Ray { origin: ray.origin * scale, ..*ray });
        let mut waiting = Waiting { children: [(0.0, 0); PLACES], count: 0 };
        let mut next = Some(0);
        while let Some(child) = next {
            if child < IS_LEAF {
                tests.boxes += u64::from(tree.counts[child as usize]);
                waiting.push(tree.entered(child as usize, &slabs, nearest.t * scale));
            } else {
                let leaf = &tree.leaves[(child & !IS_LEAF) as usize];
                tests.primitives += u64::from(leaf.primitives);
                nearest = self.blocks.numbers(leaf).fold(nearest, take);
            }
            next = waiting.pop(nearest.t * scale);
        }
        nearest
    }
}

impl Tree {
    /// The children of a node that a ray enters no farther than `limit`, and where.
    fn entered(&self, node: usize, slabs: &Slabs, limit: f64) -> impl Iterator<Item = (f64, u32)> {
        let width = self.children.len() / self.counts.len();
        let faces = &self.faces[node * 6 * width..][..6 * width];
        (0..self.counts[node] as usize).filter_map(move |lane| {
            let side = |first: usize| [0, 1, 2].map(|axis| f64::from(faces[(first + axis) * width + lane]));
            let enter = slabs.enter(&[side(0), side(3)], limit)?;
            Some((enter, self.children[node * width + lane].to_bits()))
        })
    }
}

/// Children to come back to, and where the ray enters their boxes.
struct Waiting {
    children: [(f64, u32); PLACES],
    count: usize,
}

impl Waiting {
    /// Keeps children, the nearest of them last.
    fn push(&mut self, children: impl Iterator<Item = (f64, u32)>) {
        let before = self.count;
        for child in children {
            self.children[self.count] = child;
            self.count += 1;
        }
        self.children[before..self.count].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }

    /// The last one whose box begins no farther than `limit`. At the very distance of the nearest so far a lower number may win the tie.
    fn pop(&mut self, limit: f64) -> Option<u32> {
        while self.count > 0 {
            self.count -= 1;
            let (enter, child) = self.children[self.count];
            if enter <= limit {
                return Some(child);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::lanes::walks::walks;
    use crate::scene::{SCENES, load};
    use crate::simd::{Precision, levels};

    /// In both precisions it is what the scene's own search finds, for rays of walks and rays down to the edges between things.
    #[test]
    fn what_is_found_is_what_the_scene_finds() {
        let mut compared = 0;
        for name in SCENES.iter().map(|(name, _)| *name).chain(["spheres:5000", "imbalance:40", "bumpy-ball:20000"]) {
            let scene = load(name).unwrap().accelerated("sah").unwrap();
            let view = scene.camera.view(8, 6);
            let (walks, edges) = walks(&scene, 1000);
            for (level, precision) in levels().flat_map(|level| Precision::ALL.map(|precision| (level, precision))) {
                let wide = Wide::of(&scene, scene.hierarchy.clone(), level, precision, &scene.enclosing(&view));
                for (ray, from) in walks.iter().chain(&edges) {
                    for digits in [f32::MANTISSA_DIGITS, f64::MANTISSA_DIGITS] {
                        let [mut own, mut others] = [Tests::default(); 2];
                        let found = wide.surely_nearest(&scene, ray, *from, digits, &mut own);
                        assert_eq!(found, scene.nearest(ray, *from, digits, &mut others), "{name}: {ray:?}, {from:?}");
                        assert_eq!(own.boxes > 0, others.boxes > 0, "{name}");
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 100_000, "{compared}");
    }
}
