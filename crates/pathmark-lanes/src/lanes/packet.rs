//! Packets: the state of paths in lanes between two vertices, and the points that their rays met.

use super::bvh::{Scratch, Stack};
use super::others::Others;
use super::rays::Rays;
use crate::sampler::PathWords;
use crate::simd::{Apart, Float, MOST_LANES, Mask, Words};
use pathmark_tracer::math::{Bits, Frame, Ray, Rgb, Vec3, other_root};

/// Two splits leave at most three unfinished parts.
const LARGEST_STACK: usize = 3;

/// A part of a path that waits to be followed.
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) origin: Vec3,
    pub(super) direction: Vec3,
    pub(super) from: f64,
    pub(super) own_root: f64,
    pub(super) throughput: Rgb,
    pub(super) vertices: u64,
    pub(super) branch: u64,
}

const NO_PART: Part = Part {
    origin: Vec3::new(0.0, 0.0, 0.0),
    direction: Vec3::new(0.0, 0.0, 0.0),
    from: -1.0,
    own_root: f64::NAN,
    throughput: Rgb::BLACK,
    vertices: 0,
    branch: 0,
};

/// The waiting parts of a path.
pub(super) type Parts = [Part; LARGEST_STACK];

pub(super) const NO_PARTS: Parts = [NO_PART; LARGEST_STACK];

/// The paths of a packet.
pub(super) struct Packet<'a, V: Float> {
    /// The lanes with a path.
    pub(super) alive: u32,
    pub(super) rays: Rays<V>,
    pub(super) throughput: Rgb<V>,
    pub(super) collected: Rgb<V>,
    pub(super) vertices: V::Bits,
    pub(super) branch: V::Bits,
    pub(super) words: PathWords<V::Bits>,
    /// Density of the ray's direction per steradian; -1 if the vertex at its start did not aim at light.
    pub(super) density: V,
    /// The slots of the samples in the window.
    pub(super) slots: [u64; MOST_LANES],
    /// Empty if no path splits, because waiting parts take more room than all other fields. Borrowed, because the
    /// compiler ends a block at every call in the scope of a value that has to be dropped.
    waiting: &'a mut [Parts],
    depth: [u8; MOST_LANES],
    /// Working memory of searches.
    pub(super) scratch: Scratch<'a, V>,
    /// Working memory of materials.
    pub(super) others: &'a mut Others<V::One>,
}

impl<'a, V: Float> Packet<'a, V> {
    #[inline(always)]
    pub(super) fn new(waiting: &'a mut [Parts], stacks: &'a mut [Stack], others: &'a mut Others<V::One>) -> Self {
        let zero = V::splat(0.0);
        let (vector, colour) = (Vec3::new(zero, zero, zero), Rgb { r: zero, g: zero, b: zero });
        let none = V::Bits::splat(0);
        Self {
            alive: 0,
            rays: Rays {
                ray: Ray { origin: vector, direction: vector },
                from: V::splat(-1.0),
                own_root: V::splat(f64::NAN),
            },
            throughput: colour,
            collected: colour,
            vertices: none,
            branch: none,
            words: PathWords { path: none, sample: none },
            density: V::splat(-1.0),
            slots: [0; MOST_LANES],
            waiting,
            depth: [0; MOST_LANES],
            scratch: Scratch::new(stacks),
            others,
        }
    }

    /// Puts a part aside until the lane's current part has ended.
    #[inline(always)]
    pub(super) fn push(&mut self, lane: usize, part: Part) {
        self.waiting[lane][usize::from(self.depth[lane])] = part;
        self.depth[lane] += 1;
    }

    /// Continues with the part that was put aside last; `false` if there is none.
    #[inline(always)]
    fn pop(&mut self, lane: usize) -> bool {
        if self.depth[lane] == 0 {
            return false;
        }
        self.depth[lane] -= 1;
        let part = self.waiting[lane][usize::from(self.depth[lane])];
        set_vector(&mut self.rays.ray.origin, lane, part.origin);
        set_vector(&mut self.rays.ray.direction, lane, part.direction);
        self.rays.from.set_lane(lane, part.from);
        self.rays.own_root.set_lane(lane, part.own_root);
        self.throughput.r.set_lane(lane, part.throughput.r);
        self.throughput.g.set_lane(lane, part.throughput.g);
        self.throughput.b.set_lane(lane, part.throughput.b);
        self.vertices.set_word(lane, part.vertices);
        self.branch.set_word(lane, part.branch);
        true
    }
}

/// A lane whose part of a path has ended, in a packet of paths that split. A separate function to limit compile time,
/// see [`super::supply`].
pub(super) struct NextPart<'a, 'w, V: Float> {
    pub(super) packet: &'a mut Packet<'w, V>,
    pub(super) lane: usize,
}

impl<V: Float> Apart for NextPart<'_, '_, V> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        self.packet.pop(self.lane)
    }
}

#[inline(always)]
pub(super) fn vector<V: Float>(of: &Vec3<V>, lane: usize) -> Vec3 {
    Vec3::new(of.x.lane(lane), of.y.lane(lane), of.z.lane(lane))
}

#[inline(always)]
pub(super) fn set_vector<V: Float>(of: &mut Vec3<V>, lane: usize, value: Vec3) {
    of.x.set_lane(lane, value.x);
    of.y.set_lane(lane, value.y);
    of.z.set_lane(lane, value.z);
}

#[inline(always)]
pub(super) fn colour<V: Float>(of: &Rgb<V>, lane: usize) -> Rgb {
    Rgb { r: of.r.lane(lane), g: of.g.lane(lane), b: of.b.lane(lane) }
}

/// Whether exactly one of two masks holds.
#[inline(always)]
pub(super) fn differ<M: Mask>(a: M, b: M) -> M {
    (a & !b) | (!a & b)
}

/// Intersection points of a packet of rays.
#[derive(Clone, Copy)]
pub(super) struct Arrival<V: Float> {
    /// The lanes for which the other fields hold.
    pub(super) lanes: V::Mask,
    pub(super) t: V,
    pub(super) primitive: V,
    pub(super) point: Vec3<V>,
    /// The point relative to the centre of a sphere; meaningless on a flat surface.
    pub(super) from_center: Vec3<V>,
    pub(super) is_round: V::Mask,
    /// The outward normal.
    pub(super) normal: Vec3<V>,
    /// Whether the ray comes from the inside.
    pub(super) inside: V::Mask,
    /// Frame whose normal is on the ray's side.
    pub(super) frame: Frame<V>,
}

/// Properties of vertices that are known before their points.
#[derive(Clone, Copy)]
pub(super) struct Vertex<V: Float> {
    /// Number of vertices up to and including this one.
    pub(super) number: V::Bits,
    pub(super) albedo: Rgb<V>,
    /// The [`Kind`] of surface.
    pub(super) kind: V,
}

/// Distance at which rays along the local direction `wi` meet their surface again; NaN if they do not.
#[inline(always)]
pub(super) fn own_root<V: Float>(at: &Arrival<V>, wi: Vec3<V>, direction: Vec3<V>) -> V {
    let to_inside = differ(wi.z.lt(V::splat(0.0)), at.inside);
    V::select(at.is_round & to_inside, other_root(at.from_center, direction), V::splat(f64::NAN))
}
