//! No smaller epsilon: with one, rays hit huge walls again where they start.

use super::{Guard, Measured, Variant};
use crate::math::{Frame, Ray, Vec3, dot};
use crate::random::Random;
use crate::sampling::cosine_hemisphere;
use crate::scene::{Primitive, Sphere};
use crate::sphere::unguarded::smallpt_first_root;

pub(super) const GUARD: Guard = Guard {
    name: "huge things: no epsilon",
    error: "share of bounces off a wall of radius 1e5 that meet it where they start",
    operation: "a ray that starts on a sphere",
    with: Variant { name: "primitive and side remembered", error: || error(leave), work: |count| work(count, leave) },
    without: Variant { name: "an epsilon of 1e-10", error: || error(skip), work: |count| work(count, skip) },
};

const RADIUS: f64 = 1e5;
const EPSILON: f64 = 1e-10;

fn leave(wall: &Sphere, ray: &Ray) -> f64 {
    wall.leave(ray, true)
}

fn skip(wall: &Sphere, ray: &Ray) -> f64 {
    smallpt_first_root(ray.origin - wall.center, ray.direction, wall.radius, EPSILON)
}

/// The left wall of smallpt's box.
fn wall() -> Sphere {
    Sphere { center: Vec3::new(RADIUS + 1.0, 40.8, 81.6), radius: RADIUS }
}

/// A bounce: starts where a ray from within the box hits the wall, with a cosine-distributed direction.
fn bounce(wall: &Sphere, random: &mut Random) -> Ray {
    let origin = Vec3::new(50.0, 1.0 + 80.0 * random.unit(), 1.0 + 168.0 * random.unit());
    let target = Vec3::new(1.0, 1.0 + 80.0 * random.unit(), 1.0 + 168.0 * random.unit());
    let towards = Ray { origin, direction: (target - origin).normalized() };
    let point = origin + towards.direction * wall.meet(&towards, &());
    let inwards = -wall.normal(point);
    Ray { origin: point, direction: Frame::around(inwards).to_world(cosine_hemisphere([random.unit(), random.unit()])) }
}

fn error(next: fn(&Sphere, &Ray) -> f64) -> Measured {
    let (wall, mut random, rays) = (wall(), Random::new(89), 200_000);
    let again = (0..rays).filter(|_| {
        let ray = bounce(&wall, &mut random);
        let chord = 2.0 * RADIUS * dot(-wall.normal(ray.origin), ray.direction);
        next(&wall, &ray) < 0.5 * chord
    });
    Measured::share(again.count() as u64, rays)
}

fn work(count: u64, next: fn(&Sphere, &Ray) -> f64) -> f64 {
    let (wall, mut random) = (wall(), Random::new(90));
    let rays: [Ray; 64] = std::array::from_fn(|_| bounce(&wall, &mut random));
    (0..count as usize).map(|k| next(&wall, &rays[k % 64])).sum()
}
