//! Ray search alone, along rays that are known in advance.

use super::bvh::{Scratch, Stack, Stacks};
use super::kernel::Lanes;
use super::rays::Rays;
use crate::simd::{Float, Number, Numbers, Work, on_level, sizes_of};
use pathmark_tracer::kernel::{Counts, FirstHits, FoundRays, Start};
use pathmark_tracer::math::{Ray, Vec3, other_root};
use pathmark_tracer::scene::Scene;

/// Numbers of a ray: origin, direction, the primitive that it starts on, and the distance at which it meets that
/// primitive again.
const OF_RAY: usize = 8;

fn numbers(scene: &Scene, (Ray { origin, direction }, from): &Start) -> [f64; OF_RAY] {
    let number = from.map_or(-1.0, |from| from.primitive.into());
    let sphere = from.filter(|from| from.inside).and_then(|from| scene.primitives.spheres.get(from.primitive as usize));
    let own_root = sphere.map_or(f64::NAN, |sphere| other_root(*origin - sphere.center, *direction));
    [origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, number, own_root]
}

/// Rays in packets of `lanes` lanes. Each packet stores one number of all its rays after the other. Empty lanes of the
/// last packet repeat the last ray.
pub(super) fn in_packets(scene: &Scene, rays: &[Start], lanes: usize) -> Vec<f64> {
    let mut all = Vec::with_capacity(rays.len().next_multiple_of(lanes) * OF_RAY);
    for packet in rays.chunks(lanes) {
        let mut columns = [const { Vec::new() }; OF_RAY];
        for lane in 0..lanes {
            let row = numbers(scene, &packet[lane.min(packet.len() - 1)]);
            for (column, number) in columns.iter_mut().zip(row) {
                column.push(number);
            }
        }
        all.extend(columns.into_iter().flatten());
    }
    all
}

#[inline(always)]
pub(super) fn packet<V: Float>(numbers: &[V::One]) -> Rays<V> {
    let number = |k: usize| V::load(&numbers[k * V::LANES..]);
    let origin = Vec3 { x: number(0), y: number(1), z: number(2) };
    let direction = Vec3 { x: number(3), y: number(4), z: number(5) };
    Rays { ray: Ray { origin, direction }, from: number(6), own_root: number(7) }
}

/// Rays side by side, and the lanes that search along them.
pub(super) struct SearchOfLanes {
    lanes: Lanes,
    rays: Numbers,
    count: usize,
}

impl SearchOfLanes {
    /// Lays the rays out for these lanes.
    pub(super) fn new(lanes: Lanes, rays: &[Start]) -> Self {
        let width = sizes_of(lanes.level, lanes.precision).lanes;
        let numbers = Numbers::new(in_packets(&lanes.scene, rays, width), lanes.precision);
        Self { rays: numbers, count: rays.len(), lanes }
    }
}

impl FirstHits for SearchOfLanes {
    fn search(&self) -> FoundRays {
        let Self { lanes, rays, count } = self;
        let mut stacks = lanes.stacks();
        let work = Searching { lanes, rays, count: *count, stacks: Stacks::of_lanes(&mut stacks) };
        on_level(lanes.level, lanes.precision, work)
    }
}

struct Searching<'a> {
    lanes: &'a Lanes,
    rays: &'a Numbers,
    count: usize,
    stacks: &'a mut [Stack],
}

impl Work for Searching<'_> {
    type Output = FoundRays;

    #[inline(always)]
    fn run<V: Float>(self) -> FoundRays {
        let mut found =
            FoundRays { counts: Counts { rays: self.count as u64, ..Counts::default() }, ..FoundRays::default() };
        let numbers = <V::One as Number>::all(self.rays);
        let mut left = self.count;
        let mut scratch = Scratch::new(self.stacks);
        for numbers in numbers.chunks_exact(OF_RAY * V::LANES) {
            let here = left.min(V::LANES);
            left -= here;
            let wanted = u32::MAX >> (u32::BITS - here as u32);
            let (distance, primitive) =
                self.lanes.nearest(&packet::<V>(numbers), wanted, &mut scratch, &mut found.counts);
            for lane in (0..here).filter(|lane| primitive.lane(*lane) >= 0.0) {
                found.met += 1;
                found.distance += distance.lane(lane);
            }
        }
        found
    }
}
