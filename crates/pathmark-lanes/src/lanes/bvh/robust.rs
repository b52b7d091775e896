//! The search for sure hits along a single ray, for rays whose hits in a packet may be due to rounding alone.

use super::tree::{DISTANCES, IS_LEAF, ROWS, Tree};
use super::wide::{Search, Wide};
use crate::lanes::spheres_f32::SpheresF32;
use pathmark_tracer::math::Ray;
use pathmark_tracer::scene::{Nearest, Scene, Slabs, SurfaceOrigin, Tests};

impl Wide {
    /// Finds the same as [`Scene::nearest`] for rays in double precision: boxes with the padding of single precision,
    /// tested in double precision, exclude no sure hit. Without a tree the scene itself is searched.
    #[cold]
    #[inline(never)]
    pub(in crate::lanes) fn surely_nearest(
        &self,
        scene: &Scene,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        digits: u32,
        tests: &mut Tests,
    ) -> Nearest {
        let Search::Tree(tree) = &self.search else { return scene.nearest(ray, from, digits, tests) };
        let distance = scene.primitives.sure_distances(ray, from, digits);
        let take = |nearest: Nearest, number: u32| nearest.or_in_any_order(distance(number), number);
        let planes = self.planes.iter().map(|(number, _)| *number as u32);
        let beside = self.large.iter().flat_map(SpheresF32::numbers).chain(planes);
        let mut nearest = beside.fold(Nearest::than(f64::INFINITY), take).or_own(from, &distance);

        let scale = self.blocks.scale.0;
        let slabs = Slabs::new(&Ray { origin: ray.origin * scale, ..*ray });
        let mut waiting = Waiting { children: [(0.0, 0); DISTANCES], count: 0 };
        let mut next = Some(tree.root);
        while let Some(child) = next {
            if child < IS_LEAF {
                tests.boxes += Tree::node(child).1;
                waiting.push(tree.entered(child, &slabs, nearest.t * scale));
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
    /// The children of a node whose boxes a ray enters no farther than `limit`, and the distances of entry.
    fn entered(&self, node: u32, slabs: &Slabs, limit: f64) -> impl Iterator<Item = (f64, u32)> {
        let (width, (node, count)) = (self.width, Self::node(node));
        let rows = &self.nodes[node * ROWS * width..][..ROWS * width];
        (0..count as usize).filter_map(move |lane| {
            let side = |first: usize| [0, 1, 2].map(|axis| f64::from(rows[(2 * axis + first) * width + lane]));
            let enter = slabs.enter(&[side(0), side(1)], limit)?;
            Some((enter, rows[(ROWS - 1) * width + lane].to_bits()))
        })
    }
}

/// Waiting children, and the distances at which the ray enters their boxes.
struct Waiting {
    children: [(f64, u32); DISTANCES],
    count: usize,
}

impl Waiting {
    /// Adds children, the nearest of them last.
    fn push(&mut self, children: impl Iterator<Item = (f64, u32)>) {
        let before = self.count;
        for child in children {
            self.children[self.count] = child;
            self.count += 1;
        }
        self.children[before..self.count].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    }

    /// Removes the last child whose box begins no farther than `limit`. At exactly the nearest distance so far, a lower
    /// number may win the tie.
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
    use crate::lanes::tests::{twice, walks};
    use crate::simd::levels;
    use pathmark_tracer::math::Precision;
    use pathmark_tracer::scene::{SCENES, load};

    /// Compares with the scene's own search, for rays of walks and rays close to edges, in both precisions. Returns the
    /// number of rays, and the number of primitives that they were tested against.
    fn compare(scene: &Scene) -> [u64; 2] {
        let view = scene.camera.view(8, 6);
        let (walks, edges) = walks(scene, 1000);
        let (mut rays, mut tests) = (0, Tests::default());
        for (level, precision) in levels().flat_map(|level| Precision::ALL.map(|precision| (level, precision))) {
            let wide = Wide::of(scene, scene.hierarchy.clone(), level, precision, &scene.enclosing(&view));
            assert!(wide.has_tree(), "{}", scene.name);
            for (ray, from) in walks.iter().chain(&edges) {
                for digits in [f32::MANTISSA_DIGITS, f64::MANTISSA_DIGITS] {
                    let found = wide.surely_nearest(scene, ray, *from, digits, &mut tests);
                    let expected = scene.nearest(ray, *from, digits, &mut Tests::default());
                    assert_eq!(found, expected, "{}: {ray:?}, {from:?}", scene.name);
                    rays += 1;
                }
            }
        }
        [rays, tests.primitives]
    }

    #[test]
    fn the_search_agrees_with_the_scene() {
        let mut compared = 0;
        for name in SCENES.iter().map(|(name, _)| *name).chain(["imbalance:40"]) {
            let scene = load(name).unwrap();
            for scene in [twice(&scene), scene] {
                compared += compare(&scene.accelerated("sah").unwrap())[0];
            }
        }
        assert!(compared > 100_000, "{compared}");
    }

    #[test]
    fn size_does_not_matter() {
        for exponent in [-300, -40, 40, 300] {
            let factor = libm::exp2(f64::from(exponent));
            compare(&load("cornell-mesh").unwrap().scaled(factor).accelerated("sah").unwrap());
        }
    }

    /// Among many primitives, most are not tested.
    #[test]
    fn few_primitives_are_tested() {
        for name in ["spheres:5000", "bumpy-ball:20000"] {
            let [rays, tests] = compare(&load(name).unwrap().accelerated("sah").unwrap());
            assert!(tests < 100 * rays, "{name}: {tests} tests of {rays} rays");
        }
    }

    /// Number of primitives in all leaves whose boxes a ray enters, at any distance.
    fn in_entered_leaves(wide: &Wide, ray: &Ray) -> u64 {
        let Search::Tree(tree) = &wide.search else { return 0 };
        let slabs = Slabs::new(&Ray { origin: ray.origin * wide.blocks.scale.0, ..*ray });
        let (mut primitives, mut waiting) = (0, vec![tree.root]);
        while let Some(child) = waiting.pop() {
            if child < IS_LEAF {
                waiting.extend(tree.entered(child, &slabs, f64::INFINITY).map(|(_, child)| child));
            } else {
                primitives += u64::from(tree.leaves[(child & !IS_LEAF) as usize].primitives);
            }
        }
        primitives
    }

    /// Boxes beyond the nearest hit so far are not visited. Among scattered spheres, a ray enters more of these boxes
    /// than others.
    #[test]
    fn nodes_behind_the_nearest_hit_are_not_tested() {
        let scene = load("spheres:5000").unwrap().accelerated("sah").unwrap();
        let (walks, _) = walks(&scene, 1000);
        for level in levels() {
            let wide = Wide::of(&scene, scene.hierarchy.clone(), level, Precision::F64, &[]);
            let (mut tests, mut entered) = (Tests::default(), 0);
            for (ray, from) in &walks {
                wide.surely_nearest(&scene, ray, *from, f64::MANTISSA_DIGITS, &mut tests);
                entered += in_entered_leaves(&wide, ray);
            }
            assert!(3 * tests.primitives < 2 * entered, "{} of {entered} at {}", tests.primitives, level.name());
        }
    }
}
