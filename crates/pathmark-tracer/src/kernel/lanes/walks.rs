//! Rays to compare searches by: those of random walks through a scene, and those that hardly miss one thing or another.

use super::packet::Rays;
use crate::math::{Ray, Vec3, dot, other_root, unit};
use crate::sampling::{mix, uniform_sphere};
use crate::scene::{AllEffects, Scene, Standpoint, Tests};
use crate::simd::{Float, MOST_LANES};

/// A ray and where it starts.
pub(super) type Start = (Ray, Option<Standpoint>);

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

/// What the scalar search finds: a distance and a number, -1 for nothing.
pub(super) fn nearest(scene: &Scene, (ray, from): &Start) -> (f64, f64) {
    let found = scene.nearest(ray, *from, f64::MANTISSA_DIGITS, &mut Tests::default());
    (found.t, if found.primitive == u32::MAX { -1.0 } else { found.primitive.into() })
}

/// Rays of walks through the scene from the camera, and, where two of them meet different things, those between them down to the edge.
pub(super) fn walks(scene: &Scene, count: usize) -> (Vec<Start>, Vec<Start>) {
    let (mut walks, mut edges) = (Vec::new(), Vec::new());
    let mut random = Random(1);
    let mut start: Option<(Vec3, Standpoint)> = None;
    while walks.len() < count {
        let (origin, from) = start.map_or((scene.camera.position, None), |(point, from)| (point, Some(from)));
        let rays = [random.direction(), random.direction()].map(|direction| {
            let from = from.map(|from| {
                let normal = scene.primitives.normal::<AllEffects>(from.primitive, origin);
                Standpoint { inside: dot(normal, direction) < 0.0, ..from }
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
        // Back to the camera now and then, and where nothing is met.
        let is_lost = a < 0.0 || random.unit() < 0.1;
        start = (!is_lost).then(|| (rays[0].0.at(t), Standpoint { primitive: a as u32, inside: false }));
    }
    (walks, edges)
}

/// As many rays as there are lanes.
#[inline(always)]
pub(super) fn side_by_side<V: Float>(scene: &Scene, starts: &[Start]) -> Rays<V> {
    let mut numbers = [[0.0; MOST_LANES]; 8];
    for (lane, (Ray { origin, direction }, from)) in starts.iter().enumerate() {
        let number = from.map_or(-1.0, |from| from.primitive.into());
        let sphere =
            from.filter(|from| from.inside).and_then(|from| scene.primitives.spheres.get(from.primitive as usize));
        let own_root = sphere.map_or(f64::NAN, |sphere| other_root(*origin - sphere.center, *direction));
        let Vec3 { x, y, z } = *direction;
        for (to, value) in numbers.iter_mut().zip([origin.x, origin.y, origin.z, x, y, z, number, own_root]) {
            to[lane] = value;
        }
    }
    let mut vectors = [V::splat(0.0); 8];
    for (vector, numbers) in vectors.iter_mut().zip(numbers) {
        for (lane, number) in numbers.into_iter().enumerate().take(V::LANES) {
            vector.set_lane(lane, number);
        }
    }
    let [ox, oy, oz, x, y, z, from, own_root] = vectors;
    let ray = Ray { origin: Vec3::new(ox, oy, oz), direction: Vec3::new(x, y, z) };
    Rays { ray, from, own_root }
}
