//! No epsilon: a ray remembers the surface that it leaves, so no object is too small or too near to be seen.

use super::{Guard, Measured, Variant};
use crate::math::{Ray, Vec3, dot};
use crate::random::Random;
use crate::scene::{Primitive, Sphere};
use crate::sphere::unguarded::{SMALLPT_EPSILON, smallpt_first_root};

pub(super) const GUARD: Guard = Guard {
    name: "small things: no epsilon",
    error: "share of ways through a glass ball of radius 4e-5 that are not found",
    operation: "a ray that starts on a sphere",
    with: Variant { name: "primitive and side remembered", error: || error(leave), work: |count| work(count, leave) },
    without: Variant { name: "smallpt's epsilon, 1e-4", error: || error(skip), work: |count| work(count, skip) },
};

/// smallpt's glass ball has radius 16.5. This one is the size of a grain of flour in a box of one metre.
const RADIUS: f64 = 4e-5;

fn leave(ball: &Sphere, ray: &Ray) -> f64 {
    ball.leave(ray, true)
}

fn skip(ball: &Sphere, ray: &Ray) -> f64 {
    smallpt_first_root(ray.origin - ball.center, ray.direction, ball.radius, SMALLPT_EPSILON)
}

/// A ray from a point of the ball into it.
fn inwards(ball: &Sphere, random: &mut Random) -> Ray {
    let (normal, any) = (random.direction(), random.direction());
    let direction = if dot(any, normal) > 0.0 { -any } else { any };
    Ray { origin: ball.center + normal * ball.radius, direction }
}

fn ball() -> Sphere {
    Sphere { center: Vec3::new(73.0, 16.5, 78.0), radius: RADIUS }
}

fn error(out: fn(&Sphere, &Ray) -> f64) -> Measured {
    let (ball, mut random, rays) = (ball(), Random::new(87), 20_000);
    let lost = (0..rays).filter(|_| {
        let t = out(&ball, &inwards(&ball, &mut random));
        !(t > 0.0 && t <= 2.1 * RADIUS)
    });
    Measured::share(lost.count() as u64, rays)
}

fn work(count: u64, out: fn(&Sphere, &Ray) -> f64) -> f64 {
    let ball = Sphere { radius: 16.5, ..ball() };
    let mut random = Random::new(88);
    let rays: [Ray; 64] = std::array::from_fn(|_| inwards(&ball, &mut random));
    (0..count as usize).map(|k| out(&ball, &rays[k % 64])).sum()
}
