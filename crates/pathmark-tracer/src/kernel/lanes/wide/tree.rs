//! A hierarchy whose nodes have as many children as a register has numbers in single precision, all of whose boxes are tested at a time.

use super::blocks::{Blocks, Leaf, Making};
use super::coarse::Scale;
use super::{Best, Single};
use crate::kernel::lanes::packet::LanesOf;
use crate::scene::{Bounds, Child, Content, Tests};
use crate::simd::{Float, MOST_LANES, Mask};

/// The tree; its root is the first node.
pub(super) struct Tree {
    /// Of each node the lowest x, y and z of all children, then the highest.
    faces: Vec<f32>,
    /// Of each node as many as there are lanes: numbers of nodes, or with [`IS_LEAF`] of leaves.
    children: Vec<u32>,
    /// How many of them there are.
    counts: Vec<u32>,
    leaves: Vec<Leaf>,
}

const IS_LEAF: u32 = 1 << 31;

impl Tree {
    pub(super) fn of(nodes: &[Vec<Child>], width: usize, scale: Scale, making: &mut Making<'_>) -> Self {
        let of_leaf = |child: &Child| match &child.content {
            Content::Node(_) => None,
            Content::Primitives(primitives) => Some(primitives.len()),
        };
        let in_leaves = || nodes.iter().flatten().filter_map(of_leaf);
        making.make_room(in_leaves());
        let mut faces = Vec::with_capacity(6 * width * nodes.len());
        let mut children = Vec::with_capacity(width * nodes.len());
        let mut leaves = Vec::with_capacity(in_leaves().count());
        for node in nodes {
            let bounds: Vec<Bounds> = node.iter().map(|child| scale.padded(&child.bounds)).collect();
            for k in 0..6 {
                // What has its sides exchanged is met by no ray.
                let face = |bounds: &Bounds| if k < 3 { bounds.low[k] } else { bounds.high[k - 3] };
                let nothing = face(&Bounds::EMPTY);
                faces.extend((0..width).map(|lane| bounds.get(lane).map_or(nothing, face) as f32));
            }
            children.extend((0..width).map(|lane| match node.get(lane).map(|child| &child.content) {
                None => 0,
                Some(Content::Node(node)) => *node as u32,
                Some(Content::Primitives(primitives)) => {
                    leaves.push(making.add(primitives.iter().copied()));
                    (leaves.len() - 1) as u32 | IS_LEAF
                }
            }));
        }
        let counts = nodes.iter().map(|node| node.len() as u32).collect();
        Self { faces, children, counts, leaves }
    }

    /// Tests a ray against what is in the boxes on its way.
    #[inline(always)]
    pub(super) fn search<V: Float>(
        &self,
        blocks: &Blocks,
        ray: &Single<V>,
        best: &mut Best,
        waiting: &mut Waiting,
        tests: &mut Tests,
    ) {
        let lanes = V::Single::LANES;
        waiting.count = 0;
        let mut next = Some(0);
        while let Some(child) = next {
            if child & IS_LEAF != 0 {
                let leaf = &self.leaves[(child & !IS_LEAF) as usize];
                tests.primitives += u64::from(leaf.primitives);
                blocks.test(leaf, ray, best);
            } else {
                let node = child as usize;
                tests.boxes += u64::from(self.counts[node]);
                let (enter, met) = ray.coarse.enter(&self.faces[node * 6 * lanes..], best.nearest * blocks.scale.0);
                let met = met.bits();
                if met != 0 {
                    enter.store(&mut waiting.met);
                    next = Some(waiting.push(&self.children[node * lanes..(node + 1) * lanes], met));
                    continue;
                }
            }
            next = waiting.pop((best.nearest * blocks.scale.0) as f32);
        }
    }
}

/// Children that may wait for a ray: some 15 a level of a tree that is ten levels deep on the widest registers.
const MOST_WAITING: usize = 160;

/// Whether there is place for all children that may wait for a ray at a time in a tree of these nodes, each of which stands behind its parent.
pub(super) fn is_shallow(nodes: &[Vec<Child>]) -> bool {
    let mut below = vec![0; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev() {
        let deepest = node.iter().map(|child| match child.content {
            Content::Node(node) => below[node],
            Content::Primitives(_) => 0,
        });
        below[index] = node.len() - 1 + deepest.max().unwrap_or(0);
    }
    below[0] <= MOST_WAITING
}

/// Children to come back to.
pub(super) struct Waiting {
    children: [u32; MOST_WAITING],
    distances: [f32; MOST_WAITING],
    count: usize,
    /// Where the ray enters the boxes of one node.
    met: [f32; MOST_LANES],
}

impl Waiting {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { children: [0; MOST_WAITING], distances: [0.0; MOST_WAITING], count: 0, met: [0.0; MOST_LANES] }
    }

    /// Keeps those of a node's children that are met, which must be one or more, but for the nearest, which is returned. The others are not sorted: to
    /// look at them in the wrong order costs less.
    #[inline(always)]
    fn push(&mut self, children: &[u32], met: u32) -> u32 {
        let lane = met.trailing_zeros() as usize;
        let (mut nearest, mut distance) = (children[lane], self.met[lane]);
        for lane in LanesOf(met & (met - 1)) {
            let (child, other) = (children[lane], self.met[lane]);
            let is_nearer = other < distance;
            self.children[self.count] = if is_nearer { nearest } else { child };
            self.distances[self.count] = if is_nearer { distance } else { other };
            self.count += 1;
            nearest = if is_nearer { child } else { nearest };
            distance = if is_nearer { other } else { distance };
        }
        nearest
    }

    /// The last one whose box begins no farther than `limit`. At the very distance of the nearest so far a lower number may win the tie.
    #[inline(always)]
    fn pop(&mut self, limit: f32) -> Option<u32> {
        while self.count > 0 {
            self.count -= 1;
            if self.distances[self.count] <= limit {
                return Some(self.children[self.count]);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Counts;
    use crate::kernel::lanes::packet::Rays;
    use crate::kernel::lanes::wide::{Search, Wide};
    use crate::math::{Ray, Vec3};
    use crate::scene::{Content, Primitive, Primitives, Sphere};
    use crate::simd::{Precision, Sizes, Work, levels, on_level, sizes_of};

    const DEPTH: usize = 200;

    /// A row of spheres whose boxes are all on the x axis, though the axis meets the last one alone. Each node holds the last of its spheres and a
    /// node with those before, so a ray along the axis comes to the last one when everything else has been looked at.
    fn row(width: usize) -> (Vec<Sphere>, Vec<Vec<Child>>) {
        let count = DEPTH * (width - 1);
        let sphere = |k: usize| {
            let beside = if k + 1 < count { 0.9 } else { 0.0 };
            Sphere { center: Vec3::new(10.0 + 3.0 * k as f64, beside, beside), radius: 1.0 }
        };
        let spheres: Vec<Sphere> = (0..count).map(sphere).collect();
        let around = |range: std::ops::Range<usize>| {
            let boxes = spheres[range].iter().filter_map(Primitive::bounds);
            boxes.fold(Bounds::EMPTY, |all, own| all.and(&own))
        };
        let node = |depth: usize| {
            let end = (DEPTH - depth) * (width - 1);
            let first = end - (width - 1);
            let leaf = |k: usize| Child { bounds: around(k..k + 1), content: Content::Primitives(vec![k as u32]) };
            let deeper = Child { bounds: around(0..first), content: Content::Node(depth + 1) };
            (first..end).map(leaf).chain((depth + 1 < DEPTH).then_some(deeper)).collect()
        };
        let nodes = (0..DEPTH).map(node).collect();
        (spheres, nodes)
    }

    struct Along<'a>(&'a Wide);

    impl Work for Along<'_> {
        type Output = (f64, f64);

        #[inline(always)]
        fn run<V: Float>(self) -> (f64, f64) {
            let ray =
                Ray { origin: Vec3::splat(Vec3::new(0.0, 0.0, 0.0)), direction: Vec3::splat(Vec3::new(1.0, 0.0, 0.0)) };
            let rays = Rays { ray, from: V::splat(-1.0), own_root: V::splat(f64::NAN) };
            let found = self.0.nearest(&rays, 1, &mut Counts::default());
            (found.nearest.lane(0), found.primitive.lane(0))
        }
    }

    /// Trees may be so deep that more is left to look at than there is place for; then everything is looked at.
    #[test]
    fn what_there_is_no_place_for_is_looked_at() {
        for level in levels() {
            for precision in Precision::ALL {
                let Sizes { register, single: width, .. } = sizes_of(level, precision);
                let (spheres, nodes) = row(width);
                assert!(spheres.len() > MOST_WAITING + width && !is_shallow(&nodes));
                assert!(is_shallow(&nodes[DEPTH - 1..]));
                let bounds: Vec<Option<Bounds>> = spheres.iter().map(Primitive::bounds).collect();
                let scale = Scale::of(&bounds.iter().flatten().fold(Bounds::EMPTY, |all, own| all.and(own)));
                let primitives = Primitives { spheres, ..Primitives::default() };
                let mut making = Making::new(&primitives, &bounds, scale, None, [width, register], precision);
                let search = Search::of(Some(&nodes), width, scale, &mut making);
                let blocks = making.made();
                let wide = Wide { large: None, planes: Vec::new(), blocks, search };
                let last = primitives.spheres.len() - 1;
                let (distance, number) = on_level(level, precision, Along(&wide));
                assert_eq!(number, last as f64, "{} {precision:?}", level.name());
                assert!((distance / (9.0 + 3.0 * number) - 1.0).abs() < 1e-6, "{} {precision:?}", level.name());
            }
        }
    }
}
