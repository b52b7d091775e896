//! A hierarchy whose nodes have as many children as there are lanes, all of whose boxes are tested at a time.

use super::blocks::{Blocks, Leaf, Making};
use super::{Best, Single};
use crate::kernel::lanes::packet::LanesOf;
use crate::math::{Ray, Vec3};
use crate::scene::{Bounds, Child, Content, Tests, padding};
use crate::simd::{Float, MOST_LANES, Mask, Number, Numbers, Precision};

/// The tree; its root is the first node.
pub(super) struct Tree {
    /// Of each node the lowest x, y and z of all children, then the highest.
    faces: Numbers,
    /// Of each node as many as there are lanes: numbers of nodes, or with [`IS_LEAF`] of leaves.
    children: Vec<u32>,
    /// How many of them there are.
    counts: Vec<u32>,
    leaves: Vec<Leaf>,
}

const IS_LEAF: u32 = 1 << 31;

impl Tree {
    pub(super) fn of(nodes: &[Vec<Child>], width: usize, precision: Precision, making: &mut Making<'_>) -> Self {
        let (mut faces, mut children, mut leaves) = (Vec::new(), Vec::new(), Vec::new());
        for node in nodes {
            let bounds: Vec<Bounds> = node
                .iter()
                .map(|child| match precision {
                    // It has been padded for the scalar search.
                    Precision::F64 => child.bounds,
                    Precision::F32 => child.bounds.padded(f32::MANTISSA_DIGITS),
                })
                .collect();
            for k in 0..6 {
                // What has its sides exchanged is met by no ray.
                let face = |bounds: &Bounds| if k < 3 { bounds.low[k] } else { bounds.high[k - 3] };
                let nothing = face(&Bounds::EMPTY);
                faces.extend((0..width).map(|lane| bounds.get(lane).map_or(nothing, face)));
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
        Self { faces: Numbers::new(faces, precision), children, counts, leaves }
    }

    /// Tests a ray against what is in the boxes on its way; `false` if more was left to look at than may wait.
    #[inline(always)]
    pub(super) fn search<V: Float>(
        &self,
        blocks: &Blocks,
        slabs: &Slabs<V>,
        ray: &Single<V>,
        best: &mut Best,
        waiting: &mut Waiting<V::One>,
        tests: &mut Tests,
    ) -> bool {
        let faces = V::One::all(&self.faces);
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
                let (enter, met) = slabs.enter(&faces[node * 6 * V::LANES..], best.nearest);
                let met = met.bits();
                let children = &self.children[node * V::LANES..(node + 1) * V::LANES];
                if met.is_power_of_two() {
                    next = Some(children[met.trailing_zeros() as usize]);
                    continue;
                }
                if waiting.count + V::LANES > MOST_WAITING {
                    return false;
                }
                enter.store(&mut waiting.met);
                for lane in LanesOf(met) {
                    waiting.push(children[lane], waiting.met[lane]);
                }
            }
            next = waiting.pop(V::one(best.nearest));
        }
        true
    }
}

/// Rays, made ready for boxes: the origins, moved back and forth by their share of the padding, where distances to near and far faces are taken
/// from, and one over the directions, infinite with a plus sign where that is zero.
pub(super) struct AllSlabs<T> {
    rows: [[T; MOST_LANES]; 9],
}

impl<T: Number> AllSlabs<T> {
    #[inline(always)]
    pub(super) fn of<V: Float<One = T>>(ray: &Ray<V>) -> Self {
        let Vec3 { x, y, z } = ray.origin;
        let padding = V::splat(padding(V::SIGNIFICAND)) * x.abs().larger(y.abs()).larger(z.abs());
        let mut rows = [[T::default(); MOST_LANES]; 9];
        let axes = [(x, ray.direction.x), (y, ray.direction.y), (z, ray.direction.z)];
        for (axis, (origin, direction)) in axes.into_iter().enumerate() {
            let outwards = V::select(direction.lt(V::splat(0.0)), -padding, padding);
            (origin + outwards).store(&mut rows[axis]);
            (origin - outwards).store(&mut rows[3 + axis]);
            // Adding zero turns minus zero into zero, or the near and far faces would change places.
            (V::splat(1.0) / (direction + V::splat(0.0))).store(&mut rows[6 + axis]);
        }
        Self { rows }
    }

    #[inline(always)]
    fn three<V: Float<One = T>>(&self, first: usize, lane: usize) -> [V; 3] {
        let [x, y, z] = [self.rows[first][lane], self.rows[first + 1][lane], self.rows[first + 2][lane]];
        [V::splat(x.into()), V::splat(y.into()), V::splat(z.into())]
    }

    /// Those of one ray, the same in every lane.
    #[inline(always)]
    pub(super) fn of_lane<V: Float<One = T>>(&self, lane: usize) -> Slabs<V> {
        let backward = [6, 7, 8].map(|row: usize| usize::from(self.rows[row][lane] < T::default()));
        Slabs {
            near: self.three(0, lane),
            far: self.three(3, lane),
            inverse: self.three(6, lane),
            first: [0, 1, 2].map(|axis| axis + 3 * backward[axis]),
            last: [3, 4, 5].map(|axis| axis - 3 * backward[axis - 3]),
        }
    }
}

/// One ray, made ready for boxes.
pub(super) struct Slabs<V> {
    near: [V; 3],
    far: [V; 3],
    inverse: [V; 3],
    /// Which of the six faces it meets first and last along each axis.
    first: [usize; 3],
    last: [usize; 3],
}

impl<V: Float> Slabs<V> {
    /// Where the ray enters each of the boxes with these faces, and whether it does so not beyond `limit`.
    ///
    /// A ray along a face gives 0 times infinity, NaN, for that axis, and the comparisons then keep what the other axes say: it is let in.
    #[inline(always)]
    fn enter(&self, faces: &[V::One], limit: f64) -> (V, V::Mask) {
        let (mut enter, mut leave) = (V::splat(0.0), V::splat(limit));
        for axis in 0..3 {
            let first = V::load(&faces[self.first[axis] * V::LANES..]);
            let last = V::load(&faces[self.last[axis] * V::LANES..]);
            let first = (first - self.near[axis]) * self.inverse[axis];
            let last = (last - self.far[axis]) * self.inverse[axis];
            enter = first.larger(enter);
            leave = last.smaller(leave);
        }
        (enter, enter.le(leave))
    }
}

/// Children that may wait for a ray: some 15 a level of a tree that is six or more levels deep on the widest registers.
const MOST_WAITING: usize = 160;

/// Children to come back to, the nearest last.
pub(super) struct Waiting<T> {
    children: [u32; MOST_WAITING],
    distances: [T; MOST_WAITING],
    count: usize,
    /// Where the ray enters the boxes of one node.
    met: [T; MOST_LANES],
}

impl<T: Number> Waiting<T> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            children: [0; MOST_WAITING],
            distances: [T::default(); MOST_WAITING],
            count: 0,
            met: [T::default(); MOST_LANES],
        }
    }

    /// In its place among all that wait, so that the nearest box of all is opened next.
    #[inline(always)]
    fn push(&mut self, child: u32, distance: T) {
        let mut place = self.count;
        while place > 0 && self.distances[place - 1] < distance {
            self.children[place] = self.children[place - 1];
            self.distances[place] = self.distances[place - 1];
            place -= 1;
        }
        self.children[place] = child;
        self.distances[place] = distance;
        self.count += 1;
    }

    /// The nearest whose box begins no farther than `limit`. At the very distance of the nearest so far a lower number may win the tie.
    #[inline(always)]
    fn pop(&mut self, limit: T) -> Option<u32> {
        self.count = self.count.checked_sub(1)?;
        (self.distances[self.count] <= limit).then(|| self.children[self.count])
    }
}
