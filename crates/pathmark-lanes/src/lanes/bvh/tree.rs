//! A hierarchy whose nodes have as many children as a register holds numbers of single precision. All boxes of a node
//! are tested at a time.

use super::best::Best;
use super::blocks::{Blocks, BlocksBuilder, Leaf};
use super::coarse::Scale;
use super::collapse::{Child, CollapsedBvh, Content};
use super::ray_packet::RayPacket;
use crate::lanes::rays::LanesOf;
use crate::simd::{Aligned, Apart, Float, MOST_LANES, Table, prefetch};
use pathmark_tracer::scene::{Bounds, Tests};

/// The tree; its root is the first node.
pub(super) struct Tree {
    /// For each node the lowest x, y and z of all children, then the highest.
    pub(super) faces: Aligned<f32>,
    /// For each node one entry per lane, as bits of a number: a node's number, or with [`IS_LEAF`] a leaf's.
    pub(super) children: Aligned<f32>,
    /// Number of children of each node.
    pub(super) counts: Vec<u32>,
    pub(super) leaves: Vec<Leaf>,
}

/// Bytes of primitives that fit a processor's caches. Up to this size, prefetches cost more than waiting for memory.
const CACHED: usize = 16 << 20;

pub(super) const IS_LEAF: u32 = 1 << 31;
/// No leaf has this number.
const NOTHING: u32 = u32::MAX;

impl Tree {
    pub(super) fn of(collapsed: &CollapsedBvh, width: usize, scale: Scale, builder: &mut BlocksBuilder<'_>) -> Self {
        let of_leaf = |child: &Child| match child.content {
            Content::Node(_) => None,
            Content::Primitives { count, .. } => Some(count as usize),
        };
        let in_leaves = || collapsed.children().iter().filter_map(of_leaf);
        builder.make_room(in_leaves());
        let count = collapsed.nodes().len();
        let mut faces = Aligned::with_capacity(6 * width * count);
        let mut children = Aligned::with_capacity(width * count);
        let mut leaves = Vec::with_capacity(in_leaves().count());
        for node in collapsed.nodes() {
            let mut bounds = [Bounds::EMPTY; MOST_LANES];
            bounds.iter_mut().zip(node).for_each(|(bounds, child)| *bounds = scale.padded(&child.bounds));
            for k in 0..6 {
                // A missing child has a box with exchanged sides, which no ray in range meets.
                let face = |bounds: &Bounds| if k < 3 { bounds.low[k] } else { bounds.high[k - 3] };
                faces.extend(bounds[..width].iter().map(|bounds| face(bounds) as f32));
            }
            children.extend((0..width).map(|lane| {
                f32::from_bits(match node.get(lane).map(|child| child.content) {
                    None => 0,
                    Some(Content::Node(node)) => node,
                    Some(Content::Primitives { first, count }) => {
                        leaves.push(builder.add(collapsed.primitives(first, count).iter().copied()));
                        (leaves.len() - 1) as u32 | IS_LEAF
                    }
                })
            }));
        }
        let counts = collapsed.nodes().map(|node| node.len() as u32).collect();
        Self { faces, children, counts, leaves }
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
            (self.stacks[lane].count, self.stacks[lane].next) = (0, 0);
        }
        let mut at_nodes = self.wanted;
        while at_nodes != 0 {
            self.enter_nodes(at_nodes);
            let mut at_leaves = 0;
            for lane in LanesOf(std::mem::take(&mut at_nodes)) {
                self.go_on(lane, is_large);
                at_nodes |= u32::from(self.stacks[lane].is_at_node()) << lane;
                at_leaves |= u32::from(self.stacks[lane].is_at_leaf()) << lane;
            }
            while at_leaves != 0 {
                if self.blocks.has_spheres() {
                    self.meet_spheres(at_leaves);
                }
                if is_large {
                    self.prefetch_triangles(at_leaves);
                }
                for lane in LanesOf(std::mem::take(&mut at_leaves)) {
                    self.meet_rest(lane);
                    self.go_on(lane, is_large);
                    at_nodes |= u32::from(self.stacks[lane].is_at_node()) << lane;
                    at_leaves |= u32::from(self.stacks[lane].is_at_leaf()) << lane;
                }
            }
        }
    }
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

    /// Tests rays against the boxes of their current nodes, and keeps the children that they meet.
    #[inline(always)]
    fn enter_nodes(&mut self, at_nodes: u32) {
        let (tree, lanes) = (self.tree, V::Single::LANES);
        let mut boxes = 0;
        for lane in LanesOf(at_nodes) {
            let node = self.stacks[lane].next as usize;
            boxes += u64::from(tree.counts[node]);
            let coarse = self.rays.coarse.of_lane::<V::Single>(lane);
            // A range of known length is checked once.
            let (faces, children) = (node * 6 * lanes, node * lanes);
            let (enter, met) = coarse.enter(&tree.faces[faces..faces + 6 * lanes], self.rays.limits[lane]);
            self.stacks[lane].push(V::Single::load(&tree.children[children..children + lanes]), enter, met);
        }
        self.tests.boxes += boxes;
    }

    /// Moves a ray to its next node or leaf.
    #[inline(always)]
    fn go_on(&mut self, lane: usize, is_large: bool) {
        self.stacks[lane].pop(self.rays.limits[lane]);
        if is_large {
            self.tree.prefetch::<V>(&self.stacks[lane]);
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
        if leaf.has_rest() {
            let mut best = self.best(lane);
            self.blocks.test_rest(&leaf, self.surfaces, &self.rays.of_lane(lane), &mut best);
            self.keep(lane, &best);
        }
    }
}

impl Tree {
    /// Prefetches the next node or leaf of a ray.
    #[inline(always)]
    fn prefetch<V: Float>(&self, stack: &Stack) {
        let (lanes, next) = (V::Single::LANES, stack.next as usize);
        if stack.is_at_node() {
            prefetch::<V, _>(&self.faces, next * 6 * lanes, 6 * lanes);
            prefetch::<V, _>(&self.children, next * lanes, lanes);
        } else if stack.is_at_leaf() {
            prefetch::<V, _>(&self.leaves, next & !(IS_LEAF as usize), 1);
        }
    }
}

/// Most children that may wait for a ray: about 15 per level of a tree of ten levels, on the widest registers.
const MOST_WAITING: usize = 160;

/// Whether there is room for all children that may wait for a ray at a time, in a tree of these nodes. Each node comes
/// after its parent.
pub(super) fn is_shallow(collapsed: &CollapsedBvh) -> bool {
    let mut below = vec![0; collapsed.nodes().len()];
    for (index, node) in collapsed.nodes().enumerate().rev() {
        let deepest = node.iter().map(|child| match child.content {
            Content::Node(node) => below[node as usize],
            Content::Primitives { .. } => 0,
        });
        below[index] = node.len() - 1 + deepest.max().unwrap_or(0);
    }
    below[0] <= MOST_WAITING
}

/// The nodes and leaves that a ray has yet to visit.
#[derive(Clone)]
pub(in crate::lanes) struct Stack {
    /// The next one: the number of a node, of a leaf with [`IS_LEAF`], or [`NOTHING`].
    next: u32,
    /// Waiting children, as bits of numbers, and the distances at which the ray enters their boxes.
    children: [f32; PLACES],
    distances: [f32; PLACES],
    count: usize,
    /// The spheres of the current block that the ray comes near, as bits.
    near: u32,
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

/// Room for the waiting children, and for the children of one node, which are pushed all together.
pub(super) const PLACES: usize = MOST_WAITING + 2 * MOST_LANES;

impl Stack {
    pub(in crate::lanes) const EMPTY: Self =
        Self { next: NOTHING, children: [0.0; PLACES], distances: [0.0; PLACES], count: 0, near: 0 };

    #[inline(always)]
    fn is_at_node(&self) -> bool {
        self.next < IS_LEAF
    }

    #[inline(always)]
    fn is_at_leaf(&self) -> bool {
        self.next >= IS_LEAF && self.next != NOTHING
    }

    /// Keeps a node's children that are met, the nearest of them last. The others are not sorted: visits in the wrong
    /// order cost less.
    #[inline(always)]
    fn push<W: Float<One = f32>>(&mut self, children: W, enter: W, met: W::Mask) {
        // There is always room (`is_shallow`); with this explicit bound nothing below is checked.
        let count = self.count.min(PLACES - MOST_LANES - 1);
        self.count = children.pack_least_last(enter, met, [&mut self.children, &mut self.distances], count);
    }

    /// Continues with the last child whose box begins no farther than `limit`. At exactly the nearest distance so far,
    /// a lower number may win the tie.
    #[inline(always)]
    fn pop(&mut self, limit: f32) {
        while self.count > 0 {
            self.count -= 1;
            if self.distances[self.count] <= limit {
                self.next = self.children[self.count].to_bits();
                return;
            }
        }
        self.next = NOTHING;
    }
}

#[cfg(test)]
mod tests {
    use super::super::wide::{Scratch, Search, Wide};
    use super::*;
    use crate::lanes::rays::Rays;
    use crate::simd::{Precision, Sizes, Work, levels, on_level, sizes_of};
    use pathmark_tracer::kernel::Counts;
    use pathmark_tracer::math::{Ray, Vec3};
    use pathmark_tracer::scene::{Primitive, Primitives, Sphere};

    const DEPTH: usize = 200;

    /// A row of spheres whose boxes are all on the x axis, although the axis meets only the last sphere. Each node
    /// holds the last of its spheres and a node with the spheres before. So a ray along the axis visits the last sphere
    /// after everything else.
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
            let leaf = |k: usize| Child {
                bounds: around(k..k + 1),
                content: Content::Primitives { first: k as u32, count: 1 },
            };
            let deeper = Child { bounds: around(0..first), content: Content::Node(depth as u32 + 1) };
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
            // Without a tree the table of surfaces is not read.
            let surfaces = Table::new([[0.0; 4]], Precision::F64);
            let (found, _) = self.0.nearest(&rays, 1, &surfaces, &mut Scratch::new(&mut []), &mut Counts::default());
            (found.nearest.lane(0), found.primitive.lane(0))
        }
    }

    /// If a tree is so deep that more children may wait than there is room for, all primitives are tested.
    #[test]
    fn primitives_beyond_the_stacks_are_tested() {
        for level in levels() {
            for precision in Precision::ALL {
                let Sizes { register, single: width, .. } = sizes_of(level, precision);
                let (spheres, nodes) = row(width);
                let order: Vec<u32> = (0..spheres.len() as u32).collect();
                assert!(is_shallow(&CollapsedBvh::new(nodes[DEPTH - 1..].to_vec(), order.clone())));
                let collapsed = CollapsedBvh::new(nodes, order);
                assert!(spheres.len() > MOST_WAITING + width && !is_shallow(&collapsed));
                let bounds = spheres.iter().filter_map(Primitive::bounds);
                let scale = Scale::of(&bounds.fold(Bounds::EMPTY, |all, own| all.and(&own)));
                let primitives = Primitives { spheres, ..Primitives::default() };
                let mut builder = BlocksBuilder::new(&primitives, scale, None, [width, register], precision);
                let search = Search::of(Some(&collapsed), width, scale, &mut builder);
                let blocks = builder.made();
                let wide = Wide { large: None, planes: Vec::new(), blocks, search };
                let last = primitives.spheres.len() - 1;
                let (distance, number) = on_level(level, precision, Along(&wide));
                assert_eq!(number, last as f64, "{} {precision:?}", level.name());
                assert!((distance / (9.0 + 3.0 * number) - 1.0).abs() < 1e-6, "{} {precision:?}", level.name());
            }
        }
    }
}
