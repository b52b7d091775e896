//! A hierarchy whose nodes have as many children as a register holds numbers of single precision. All boxes of a node
//! are tested at a time.

use super::best::Best;
use super::blocks::{Blocks, BlocksBuilder, Leaf};
use super::coarse::Scale;
use super::collapse::{Child, CollapsedBvh, Content};
use super::ray_packet::RayPacket;
use crate::lanes::MOST_IN_LANES;
use crate::lanes::rays::LanesOf;
use crate::simd::{Aligned, Apart, Float, MOST_LANES, Mask, Table, prefetch};
use pathmark_tracer::scene::{Bounds, Tests};

/// The tree; its root is the first node.
pub(super) struct Tree {
    /// For each node [`ROWS`] of numbers, one for each lane: the lowest x of its children, their highest, likewise y
    /// and z, and the children as bits of numbers: a leaf's number with [`IS_LEAF`], or a node's with the number of its
    /// own children from the bit [`COUNT`] on.
    pub(super) nodes: Aligned<f32>,
    pub(super) leaves: Vec<Leaf>,
    pub(super) root: u32,
    /// Children of a node at most.
    pub(super) width: usize,
}

/// Bytes of primitives that fit a processor's caches. Up to this size, prefetches cost more than waiting for memory.
const CACHED: usize = 16 << 20;

pub(super) const IS_LEAF: u32 = 1 << 31;
/// The bit of a node's number from which on it holds the number of its children. There are not more nodes than primitives.
const COUNT: u32 = MOST_IN_LANES.trailing_zeros();
/// Rows of a node. The last one holds its children.
pub(super) const ROWS: usize = 7;

impl Tree {
    pub(super) fn of(collapsed: &CollapsedBvh, width: usize, scale: Scale, builder: &mut BlocksBuilder<'_>) -> Self {
        let of_leaf = |child: &Child| match child.content {
            Content::Node(_) => None,
            Content::Primitives { count, .. } => Some(count as usize),
        };
        let in_leaves = || collapsed.children().iter().filter_map(of_leaf);
        builder.make_room(in_leaves());
        let counts: Vec<u32> = collapsed.nodes().map(|node| node.len() as u32).collect();
        let numbered = |node: u32| counts[node as usize] << COUNT | node;
        let mut nodes = Aligned::with_capacity(ROWS * width * counts.len());
        let mut leaves = Vec::with_capacity(in_leaves().count());
        for node in collapsed.nodes() {
            let mut bounds = [Bounds::EMPTY; MOST_LANES];
            bounds.iter_mut().zip(node).for_each(|(bounds, child)| *bounds = scale.padded(&child.bounds));
            for k in 0..6 {
                // A missing child has a box with exchanged sides, which no ray in range meets.
                let face = |bounds: &Bounds| if k % 2 == 0 { bounds.low[k / 2] } else { bounds.high[k / 2] };
                nodes.extend(bounds[..width].iter().map(|bounds| face(bounds) as f32));
            }
            nodes.extend((0..width).map(|lane| {
                f32::from_bits(match node.get(lane).map(|child| child.content) {
                    None => 0,
                    Some(Content::Node(node)) => numbered(node),
                    Some(Content::Primitives { first, count }) => {
                        leaves.push(builder.add(collapsed.primitives(first, count).iter().copied()));
                        (leaves.len() - 1) as u32 | IS_LEAF
                    }
                })
            }));
        }
        Self { nodes, leaves, root: numbered(0), width }
    }

    /// The place of a node, and the number of its children.
    #[inline(always)]
    pub(super) fn node(node: u32) -> (usize, u64) {
        ((node & ((1 << COUNT) - 1)) as usize, u64::from(node >> COUNT))
    }
}

/// The search along all rays of a packet. A separate function, because it needs all registers for itself.
///
/// The rays go down the tree in turns. While a ray's box test is computed, there is time to compute some other rays'
/// tests, too, and no processor predicts where a ray continues. So the boxes of all rays are tested first, and then all
/// rays continue. Waits for memory overlap in this way.
pub(super) struct Traversal<'a, V: Float> {
    pub(super) tree: &'a Tree,
    pub(super) blocks: &'a Blocks,
    pub(super) surfaces: &'a Table,
    pub(super) rays: &'a mut RayPacket<V>,
    pub(super) wanted: u32,
    pub(super) stacks: &'a mut [Stack; MOST_LANES],
    pub(super) tests: &'a mut Tests,
}

impl<V: Float> Apart for Traversal<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run(mut self) {
        let is_large = self.blocks.bytes() > CACHED;
        for lane in LanesOf(self.wanted) {
            (self.stacks[lane].count, self.stacks[lane].next) = (0, self.tree.root);
        }
        let mut at_nodes = self.wanted;
        while at_nodes != 0 {
            let mut turn = self.enter_nodes(at_nodes);
            if is_large {
                self.prefetch_next(&turn);
            }
            for lane in LanesOf(turn.missed) {
                self.go_back(lane, is_large, &mut turn);
            }
            while turn.at_leaves != 0 {
                let at_leaves = std::mem::take(&mut turn.at_leaves);
                if self.blocks.has_spheres() {
                    self.meet_spheres(at_leaves);
                }
                if is_large {
                    self.prefetch_triangles(at_leaves);
                }
                for lane in LanesOf(at_leaves) {
                    self.meet_rest(lane);
                    self.go_back(lane, is_large, &mut turn);
                }
            }
            at_nodes = turn.at_nodes;
        }
    }
}

/// The lanes of rays, by where they are.
#[derive(Default)]
struct Turn {
    at_nodes: u32,
    at_leaves: u32,
    /// Rays that have met no child of their node.
    missed: u32,
}

impl<V: Float> Traversal<'_, V> {
    #[inline(always)]
    fn leaf(&self, lane: usize) -> &Leaf {
        &self.tree.leaves[(self.stacks[lane].next & !IS_LEAF) as usize]
    }

    #[inline(always)]
    fn best(&self, lane: usize) -> Best {
        Best { nearest: self.rays.nearest[lane].into(), primitive: self.rays.primitive[lane].into() }
    }

    #[inline(always)]
    fn keep(&mut self, lane: usize, best: &Best) {
        self.rays.nearest[lane] = V::one(best.nearest);
        self.rays.primitive[lane] = V::one(best.primitive);
        self.rays.limits[lane] = self.blocks.scale.limit(self.rays.nearest[lane].into());
    }

    /// Tests rays against the boxes of their current nodes. Each ray continues with the nearest child that it meets,
    /// and the others wait.
    #[inline(always)]
    fn enter_nodes(&mut self, at_nodes: u32) -> Turn {
        let (tree, lanes) = (self.tree, V::Single::LANES);
        let (mut turn, mut boxes) = (Turn::default(), 0);
        for lane in LanesOf(at_nodes) {
            let (node, count) = Tree::node(self.stacks[lane].next);
            boxes += count;
            let coarse = self.rays.coarse.of_lane::<V::Single>(lane);
            // A range of known length is checked once.
            let (first, length) = (node * ROWS * lanes, ROWS * lanes);
            let rows = &tree.nodes[first..first + length];
            let (enter, met) = coarse.enter(rows, self.rays.limits[lane]);
            let children = (ROWS - 1) * lanes;
            let nearest = self.stacks[lane].push((first + children) as u32, enter, met);
            let child = rows[children + nearest].to_bits();
            self.stacks[lane].next = child;
            turn.missed |= u32::from(met.bits() == 0) << lane;
            turn.at_leaves |= (child / IS_LEAF) << lane;
        }
        turn.at_leaves &= !turn.missed;
        turn.at_nodes = at_nodes & !turn.missed & !turn.at_leaves;
        self.tests.boxes += boxes;
        turn
    }

    /// Moves a ray to a waiting child.
    #[inline(always)]
    fn go_back(&mut self, lane: usize, is_large: bool, turn: &mut Turn) {
        let stack = &mut self.stacks[lane];
        let Some(child) = stack.pop::<V::Single>(&self.tree.nodes, self.rays.limits[lane]) else { return };
        stack.next = child;
        let is_at_leaf = child / IS_LEAF;
        turn.at_nodes |= (1 - is_at_leaf) << lane;
        turn.at_leaves |= is_at_leaf << lane;
        if is_large {
            if is_at_leaf == 0 { self.tree.prefetch_node::<V>(child) } else { self.tree.prefetch_leaf::<V>(child) }
        }
    }

    #[inline(always)]
    fn prefetch_next(&self, turn: &Turn) {
        for lane in LanesOf(turn.at_nodes) {
            self.tree.prefetch_node::<V>(self.stacks[lane].next);
        }
        for lane in LanesOf(turn.at_leaves) {
            self.tree.prefetch_leaf::<V>(self.stacks[lane].next);
        }
    }

    /// Tests rays against the first spheres of their current leaves: a quick test along all rays, then exact tests of
    /// the spheres that they come near.
    #[inline(always)]
    fn meet_spheres(&mut self, at_leaves: u32) {
        let mut near = 0_u32;
        for lane in LanesOf(at_leaves) {
            let block = self.leaf(lane).spheres;
            if block[0] < block[1] {
                let of_block = self.blocks.near(block[0], &self.rays.of_lane(lane), self.rays.limits[lane]);
                self.stacks[lane].near = of_block;
                near |= u32::from(of_block != 0) << lane;
            }
        }
        for lane in LanesOf(near) {
            let mut best = self.best(lane);
            let (block, near) = (self.leaf(lane).spheres[0], self.stacks[lane].near);
            self.blocks.test_near(block, near, self.surfaces, &self.rays.of_lane(lane), &mut best);
            self.keep(lane, &best);
        }
    }

    #[inline(always)]
    fn prefetch_triangles(&self, at_leaves: u32) {
        for lane in LanesOf(at_leaves) {
            self.blocks.prefetch::<V>(self.leaf(lane));
        }
    }

    /// Tests a ray against the other primitives of its current leaf.
    #[inline(always)]
    fn meet_rest(&mut self, lane: usize) {
        let leaf = *self.leaf(lane);
        self.tests.primitives += u64::from(leaf.primitives);
        let (has_more_spheres, has_triangles) = (leaf.has_more_spheres(), leaf.has_triangles());
        if has_more_spheres | has_triangles {
            let mut best = self.best(lane);
            if has_more_spheres {
                self.blocks.test_more_spheres(&leaf, self.surfaces, &self.rays.of_lane(lane), &mut best);
            }
            if has_triangles {
                self.blocks.test_triangles::<V>(&leaf, self.rays.from(lane), &self.rays.sheared(lane), &mut best);
            }
            self.keep(lane, &best);
        }
    }
}

impl Tree {
    #[inline(always)]
    fn prefetch_node<V: Float>(&self, node: u32) {
        let length = ROWS * V::Single::LANES;
        prefetch::<V, _>(&self.nodes, Self::node(node).0 * length, length);
    }

    #[inline(always)]
    fn prefetch_leaf<V: Float>(&self, leaf: u32) {
        prefetch::<V, _>(&self.leaves, (leaf & !IS_LEAF) as usize, 1);
    }
}

/// Most nodes, one below the other, that may have waiting children.
const MOST_LEVELS: usize = 110;
/// Room for the distances of all children of each level: 29 levels of 16 lanes, 58 of 8. The robust search keeps fewer
/// children than that.
pub(super) const DISTANCES: usize = 29 * 16;

/// The most levels of nodes with so many children.
const fn most_levels(width: usize) -> usize {
    if DISTANCES / width < MOST_LEVELS { DISTANCES / width } else { MOST_LEVELS }
}

/// Whether there is room for all children that may wait for a ray at a time, in a tree of these nodes with so many
/// children. Each node comes after its parent.
pub(super) fn is_shallow(collapsed: &CollapsedBvh, width: usize) -> bool {
    let mut levels = vec![0; collapsed.nodes().len()];
    for (index, node) in collapsed.nodes().enumerate().rev() {
        let below = node.iter().map(|child| match child.content {
            Content::Node(node) => levels[node as usize],
            Content::Primitives { .. } => 0,
        });
        levels[index] = 1 + below.max().unwrap_or(0);
    }
    levels[0] <= most_levels(width)
}

/// The nodes and leaves that a ray has yet to visit.
#[derive(Clone)]
#[repr(align(64))]
pub(in crate::lanes) struct Stack {
    /// For each level the distances at which the ray enters the boxes of all children of a node.
    distances: [f32; DISTANCES],
    levels: [Waiting; MOST_LEVELS],
    count: usize,
    /// The current one: the number of a node, or with [`IS_LEAF`] of a leaf.
    next: u32,
    /// The spheres of the current block that the ray comes near, as bits.
    near: u32,
}

/// The children of a node that a ray has yet to visit.
#[derive(Clone, Copy)]
struct Waiting {
    /// The place of the node's first child.
    first: u32,
    /// As bits, not 0 below `count`; lanes whose boxes begin beyond the limit at the time of the last removal are left out.
    which: u32,
}

/// The stacks of all lanes, aligned to a page.
#[derive(Clone)]
#[repr(align(4096))]
pub(in crate::lanes) struct Stacks(pub(in crate::lanes) [Stack; MOST_LANES]);

impl Stacks {
    pub(in crate::lanes) fn new() -> Box<Self> {
        static EMPTY: Stacks = Stacks([Stack::EMPTY; MOST_LANES]);
        Box::new(EMPTY.clone())
    }

    /// The stack of each lane; none if there is no tree.
    pub(in crate::lanes) fn of_lanes(stacks: &mut Option<Box<Self>>) -> &mut [Stack] {
        stacks.as_mut().map_or(&mut [], |stacks| &mut stacks.0)
    }
}

impl Stack {
    pub(in crate::lanes) const EMPTY: Self = Self {
        distances: [0.0; DISTANCES],
        levels: [Waiting { first: 0, which: 0 }; MOST_LEVELS],
        count: 0,
        next: 0,
        near: 0,
    };

    /// Keeps a node's children that are met and returns the lane of the nearest; the others wait. `first` is the place
    /// of the node's first child. If none is met, the result is any lane.
    #[inline(always)]
    fn push<W: Float<One = f32>>(&mut self, first: u32, enter: W, met: W::Mask) -> usize {
        // There is always room (`is_shallow`); with this explicit bound nothing below is checked.
        debug_assert!(self.count < most_levels(W::LANES));
        let count = self.count.min(most_levels(W::LANES) - 1);
        enter.store(&mut self.distances[count * W::LANES..][..W::LANES]);
        let nearest = nearest(enter, met);
        let which = met.bits() & !(1 << nearest);
        self.levels[count] = Waiting { first, which };
        self.count = count + usize::from(which != 0);
        nearest
    }

    /// Removes the nearest waiting child of the last node that has one, and returns it. Its box begins no farther than
    /// `limit`: at exactly the nearest distance so far, a lower number may win the tie.
    #[inline(always)]
    fn pop<W: Float<One = f32>>(&mut self, nodes: &[f32], limit: f32) -> Option<u32> {
        while let Some(last) = self.count.checked_sub(1) {
            let last = last.min(most_levels(W::LANES) - 1);
            let Waiting { first, which } = self.levels[last];
            let enter = W::load(&self.distances[last * W::LANES..][..W::LANES]);
            let is_near = enter.le(W::splat(limit.into())) & W::Mask::from_bits(which);
            let nearest = nearest(enter, is_near);
            let which = is_near.bits();
            let others = which & !(1 << nearest);
            self.levels[last].which = others;
            self.count = last + usize::from(others != 0);
            if which != 0 {
                return Some(nodes[first as usize + nearest].to_bits());
            }
        }
        None
    }
}

/// The first lane with the least of some numbers; any lane if there are none.
#[inline(always)]
fn nearest<W: Float<One = f32>>(distances: W, which: W::Mask) -> usize {
    let distances = W::select(which, distances, W::splat(f64::INFINITY));
    distances.equal(W::splat(distances.least())).bits().trailing_zeros() as usize % W::LANES
}

#[cfg(test)]
mod tests {
    use super::super::wide::{Scratch, Search, Wide};
    use super::*;
    use crate::lanes::rays::Rays;
    use crate::simd::{Precision, Sizes, Work, levels, on_level, sizes_of};
    use pathmark_tracer::kernel::Counts;
    use pathmark_tracer::math::{Ray, Real, Vec3};
    use pathmark_tracer::scene::{Primitive, Primitives, Sphere};

    /// A row of spheres in a tree of so many levels, whose boxes are all on the x axis, although the axis meets only the last sphere. Each node
    /// holds the last of its spheres and a node with the spheres before. So a ray along the axis visits the last sphere
    /// after everything else.
    fn row(width: usize, levels: usize) -> (Vec<Sphere>, Vec<Vec<Child>>) {
        let count = levels * (width - 1);
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
            let end = (levels - depth) * (width - 1);
            let first = end - (width - 1);
            let leaf = |k: usize| Child {
                bounds: around(k..k + 1),
                content: Content::Primitives { first: k as u32, count: 1 },
            };
            let deeper = Child { bounds: around(0..first), content: Content::Node(depth as u32 + 1) };
            (first..end).map(leaf).chain((depth + 1 < levels).then_some(deeper)).collect()
        };
        let nodes = (0..levels).map(node).collect();
        (spheres, nodes)
    }

    struct NearestOf;

    impl Work for NearestOf {
        type Output = usize;

        #[inline(always)]
        fn run<V: Float>(self) -> usize {
            let lanes = V::Single::LANES;
            let mut compared = 0;
            for which in (1..1_u32 << lanes).step_by(if lanes > 8 { 47 } else { 1 }) {
                for shift in 0..5 {
                    let distances: [f32; MOST_LANES] = std::array::from_fn(|lane| ((7 * lane + shift) % 5) as f32);
                    let mask = <V::Single as Real>::Mask::from_bits(which);
                    let met = (0..lanes).filter(|lane| which >> lane & 1 == 1);
                    let expected = met.min_by(|a, b| distances[*a].total_cmp(&distances[*b]));
                    assert_eq!(Some(nearest(V::Single::load(&distances), mask)), expected, "{which:b}, {distances:?}");
                    compared += 1;
                }
            }
            compared
        }
    }

    /// Among equally near children the first one counts.
    #[test]
    fn the_nearest_lane_is_found() {
        for (level, precision) in levels().flat_map(|level| Precision::ALL.map(|precision| (level, precision))) {
            assert!(on_level(level, precision, NearestOf) > 10, "{} {precision:?}", level.name());
        }
    }

    struct Along<'a>(&'a Wide, &'a Table);

    impl Work for Along<'_> {
        type Output = (f64, f64);

        #[inline(always)]
        fn run<V: Float>(self) -> (f64, f64) {
            let ray =
                Ray { origin: Vec3::splat(Vec3::new(0.0, 0.0, 0.0)), direction: Vec3::splat(Vec3::new(1.0, 0.0, 0.0)) };
            let rays = Rays { ray, from: V::splat(-1.0), own_root: V::splat(f64::NAN) };
            let (Self(wide, surfaces), mut stacks) = (self, Stacks::new());
            let (found, _) = wide.nearest(&rays, 1, surfaces, &mut Scratch::new(&mut stacks.0), &mut Counts::default());
            (found.nearest.lane(0), found.primitive.lane(0))
        }
    }

    /// In a tree with as many levels as there is room for, the child that waited longest is found. If it is deeper, all
    /// primitives are tested.
    #[test]
    fn the_last_of_the_waiting_children_is_found() {
        for (level, precision) in levels().flat_map(|level| Precision::ALL.map(|precision| (level, precision))) {
            let Sizes { register, single: width, .. } = sizes_of(level, precision);
            let most = most_levels(width);
            for depth in [1, most - 1, most, most + 1, 200] {
                let (spheres, nodes) = row(width, depth);
                let order: Vec<u32> = (0..spheres.len() as u32).collect();
                let collapsed = CollapsedBvh::new(nodes, order);
                let bounds = spheres.iter().filter_map(Primitive::bounds);
                let scale = Scale::of(&bounds.fold(Bounds::EMPTY, |all, own| all.and(&own)));
                let row = |Sphere { center, radius }: &Sphere| [center.x, center.y, center.z, *radius];
                let surfaces = Table::new(spheres.iter().map(row), precision);
                let last = spheres.len() - 1;
                let primitives = Primitives { spheres, ..Primitives::default() };
                let mut builder = BlocksBuilder::new(&primitives, scale, None, [width, register], precision);
                let search = Search::of(Some(&collapsed), width, scale, &mut builder);
                let what = format!("{} {precision:?}, {depth} levels", level.name());
                assert_eq!(matches!(search, Search::Tree(_)), depth <= most, "{what}");
                let blocks = builder.made();
                let wide = Wide { large: None, planes: Vec::new(), blocks, search };
                let (distance, number) = on_level(level, precision, Along(&wide, &surfaces));
                assert_eq!(number, last as f64, "{what}");
                assert!((distance / (9.0 + 3.0 * number) - 1.0).abs() < 1e-6, "{what}");
            }
        }
    }
}
