//! Scenes and rays for comparisons of searches: rays of random walks through a scene, and rays close to edges.

use super::rays::Rays;
use super::search::{in_packets, packet};
use crate::simd::Float;
use pathmark_tracer::kernel::Start;
use pathmark_tracer::math::{Ray, Vec3, dot, unit};
use pathmark_tracer::sampling::{mix, uniform_sphere};
use pathmark_tracer::scene::{AllEffects, Scene, SurfaceOrigin, Tests};

struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 += 1;
        unit(mix(self.0))
    }

    fn direction(&mut self) -> Vec3 {
        uniform_sphere([self.unit(), self.unit()])
    }
}

/// The result of the scalar search: a distance and a number, -1 for nothing.
pub(super) fn nearest(scene: &Scene, (ray, from): &Start) -> (f64, f64) {
    let found = scene.nearest(ray, *from, f64::MANTISSA_DIGITS, &mut Tests::default());
    (found.t, if found.primitive == u32::MAX { -1.0 } else { found.primitive.into() })
}

/// Rays of random walks through the scene from the camera. If two of them meet different primitives, the second list
/// gets rays between them that approach the edge.
pub(super) fn walks(scene: &Scene, count: usize) -> (Vec<Start>, Vec<Start>) {
    let (mut walks, mut edges) = (Vec::new(), Vec::new());
    let mut random = Random(1);
    let mut start: Option<(Vec3, SurfaceOrigin)> = None;
    while walks.len() < count {
        let (origin, from) = start.map_or((scene.camera.position, None), |(point, from)| (point, Some(from)));
        let rays = [random.direction(), random.direction()].map(|direction| {
            let from = from.map(|from| {
                let normal = scene.primitives.normal::<AllEffects>(from.primitive, origin);
                SurfaceOrigin { inside: dot(normal, direction) < 0.0, ..from }
            });
            (Ray { origin, direction }, from)
        });
        let [(t, a), (_, b)] = [nearest(scene, &rays[0]), nearest(scene, &rays[1])];
        walks.extend(rays);
        let is_same_side = rays[0].1.is_none_or(|one| rays[1].1.is_some_and(|two| one.inside == two.inside));
        if a != b && is_same_side && edges.len() < count {
            let [mut one, mut two] = [rays[0].0.direction, rays[1].0.direction];
            for _ in 0..60 {
                let ray = Ray { origin, direction: (one + two).normalized() };
                edges.push((ray, rays[0].1));
                let met = nearest(scene, &(ray, rays[0].1)).1;
                *(if met == a { &mut one } else { &mut two }) = ray.direction;
            }
        }
        // Back to the camera now and then, and after a ray that meets nothing.
        let is_lost = a < 0.0 || random.unit() < 0.1;
        start = (!is_lost).then(|| (rays[0].0.at(t), SurfaceOrigin { primitive: a as u32, inside: false }));
    }
    (walks, edges)
}

/// A packet of as many rays as there are lanes.
#[inline(always)]
pub(super) fn side_by_side<V: Float>(scene: &Scene, starts: &[Start]) -> Rays<V> {
    let numbers: Vec<V::One> = in_packets(scene, starts, V::LANES).into_iter().map(V::one).collect();
    packet(&numbers)
}

/// The scene with every primitive twice, so that every hit is a tie.
pub(super) fn twice(scene: &Scene) -> Scene {
    let mut twice = scene.clone();
    let primitives = &mut twice.primitives;
    let (spheres, planes) = (primitives.spheres.len(), primitives.planes.len());
    primitives.spheres.extend_from_within(..);
    primitives.planes.extend_from_within(..);
    primitives.triangles.extend_from_within(..);
    let owners = |range: std::ops::Range<usize>| scene.owners[range].repeat(2);
    let [first, second] = [spheres, spheres + planes];
    twice.owners = [owners(0..first), owners(first..second), owners(second..scene.owners.len())].concat();
    twice
}
