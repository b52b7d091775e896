//! Double precision: in single precision no formula is accurate for the walls of smallpt's box, spheres of radius 1e5.

use super::{Guard, InRender, Measured, Often, Variant};
use crate::math::{Real, Vec3, dot, first_root};
use crate::random::Random;
use crate::sphere::exact::Exact;

pub(super) const GUARD: Guard = Guard {
    name: "double precision",
    error: "mean distance of a hit from the walls of smallpt's box, scene units",
    operation: "a ray against a sphere",
    in_render: InRender { scene: "cornell", often: Often::Test(1.0) },
    with: Variant { name: "f64", error: error::<f64>, work: work::<f64> },
    without: Variant { name: "f32", error: error::<f32>, work: work::<f32> },
};

const RAYS: usize = 20_000;
const RADIUS: f64 = 1e5;
/// Centres of left, right, back, front, floor and ceiling.
const WALLS: [[f64; 3]; 6] = [
    [RADIUS + 1.0, 40.8, 81.6],
    [99.0 - RADIUS, 40.8, 81.6],
    [50.0, 40.8, RADIUS],
    [50.0, 40.8, 170.0 - RADIUS],
    [50.0, RADIUS, 81.6],
    [50.0, 81.6 - RADIUS, 81.6],
];

/// A ray from inside the box, with coordinates that single precision represents exactly.
fn ray(random: &mut Random) -> (Vec3, Vec3) {
    let single = |x: f64| f64::from(x as f32);
    let origin = Vec3::new(2.0 + 96.0 * random.unit(), 1.0 + 79.0 * random.unit(), 1.0 + 168.0 * random.unit());
    let [o, d] = [origin, random.direction()].map(|v| Vec3::new(single(v.x), single(v.y), single(v.z)));
    (o, d)
}

/// A number type that can be converted from `f64` and back.
trait Number: Real {
    fn back(self) -> f64;
}

impl Number for f64 {
    fn back(self) -> f64 {
        self
    }
}

impl Number for f32 {
    fn back(self) -> f64 {
        f64::from(self)
    }
}

fn first<T: Number>(origin: Vec3, d: Vec3, center: [f64; 3]) -> f64 {
    let vector = |v: Vec3| Vec3::new(T::splat(v.x), T::splat(v.y), T::splat(v.z));
    let (origin, d) = (vector(origin), vector(d));
    first_root(origin - vector(Vec3::from(center)), d, dot(d, d), T::splat(RADIUS)).back()
}

fn error<T: Number>() -> Measured {
    let mut random = Random::new(81);
    let mut errors = Vec::with_capacity(RAYS);
    for k in 0..RAYS {
        let ((origin, d), center) = (ray(&mut random), WALLS[k % 6]);
        // Seen from inside, the first root ahead is the far one.
        let exact = Exact::of(origin - Vec3::from(center), d, RADIUS).roots.map_or(f64::NAN, |[_, far]| far);
        errors.push((first::<T>(origin, d, center) - exact).abs());
    }
    Measured::mean(&errors)
}

fn work<T: Number>(count: u64) -> f64 {
    let mut random = Random::new(82);
    let rays: [(Vec3, Vec3); 64] = std::array::from_fn(|_| ray(&mut random));
    let mut sum = 0.0;
    for k in 0..count as usize {
        let (origin, d) = rays[k % 64];
        sum += first::<T>(origin, d, WALLS[k % 6]);
    }
    sum
}
