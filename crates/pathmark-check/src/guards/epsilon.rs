//! No epsilon: a ray remembers the surface that it leaves. So no object is too small or too near to be seen, and rays do
//! not hit huge walls again where they start, as with a smaller epsilon.

use super::{Guard, InRender, Measured, Often, variant};
use crate::math::{Frame, Ray, Vec3, dot};
use crate::random::Random;
use crate::sampling::cosine_hemisphere;
use crate::scene::{Primitive, Sphere};
use crate::sphere::formulas::{SMALLPT_EPSILON, smallpt_first_root};

pub(super) const SMALL: Guard = Guard {
    name: "small things: no epsilon",
    error: "share of ways through a glass ball of radius 4e-5 that are not found",
    operation: "a ray that starts on a sphere",
    in_render: InRender { scene: "cornell", often: Often::BounceAtMost },
    with: variant!("primitive and side remembered", lost, through, leave),
    without: variant!("smallpt's epsilon, 1e-4", lost, through, skip_smallpts),
};

pub(super) const HUGE: Guard = Guard {
    name: "huge things: no epsilon",
    error: "share of bounces off a wall of radius 1e5 that meet it where they start",
    operation: "a ray that starts on a sphere",
    in_render: InRender { scene: "cornell", often: Often::BounceAtMost },
    with: variant!("primitive and side remembered", again, off, leave),
    without: variant!("an epsilon of 1e-10", again, off, skip_tiny),
};

/// The distance at which a ray that starts on a sphere, and goes inwards, meets it again.
type Next = fn(&Sphere, &Ray) -> f64;

fn leave(sphere: &Sphere, ray: &Ray) -> f64 {
    sphere.leave(ray, true)
}

fn skip_smallpts(sphere: &Sphere, ray: &Ray) -> f64 {
    smallpt_first_root(ray.origin - sphere.center, ray.direction, sphere.radius, SMALLPT_EPSILON)
}

fn skip_tiny(sphere: &Sphere, ray: &Ray) -> f64 {
    smallpt_first_root(ray.origin - sphere.center, ray.direction, sphere.radius, 1e-10)
}

/// smallpt's glass ball. The radius of the small one, 4e-5 instead of 16.5, is the size of a grain of flour in a box of
/// one metre.
fn ball(radius: f64) -> Sphere {
    Sphere { center: Vec3::new(73.0, 16.5, 78.0), radius }
}

/// A ray from a point of the ball into it.
fn inwards(ball: &Sphere, random: &mut Random) -> Ray {
    let (normal, any) = (random.direction(), random.direction());
    let direction = if dot(any, normal) > 0.0 { -any } else { any };
    Ray { origin: ball.center + normal * ball.radius, direction }
}

fn lost(next: Next) -> Measured {
    let (ball, mut random, rays) = (ball(4e-5), Random::new(87), 20_000);
    let lost = (0..rays).filter(|_| {
        let t = next(&ball, &inwards(&ball, &mut random));
        !(t > 0.0 && t <= 2.1 * ball.radius)
    });
    Measured::share(lost.count() as u64, rays)
}

fn through(count: u64, next: Next) -> f64 {
    let (ball, mut random) = (ball(16.5), Random::new(88));
    let rays: [Ray; 64] = std::array::from_fn(|_| inwards(&ball, &mut random));
    (0..count as usize).map(|k| next(&ball, &rays[k % 64])).sum()
}

/// The left wall of smallpt's box.
fn wall() -> Sphere {
    Sphere { center: Vec3::new(100_001.0, 40.8, 81.6), radius: 1e5 }
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

fn again(next: Next) -> Measured {
    let (wall, mut random, rays) = (wall(), Random::new(89), 200_000);
    let again = (0..rays).filter(|_| {
        let ray = bounce(&wall, &mut random);
        let chord = 2.0 * wall.radius * dot(-wall.normal(ray.origin), ray.direction);
        next(&wall, &ray) < 0.5 * chord
    });
    Measured::share(again.count() as u64, rays)
}

fn off(count: u64, next: Next) -> f64 {
    let (wall, mut random) = (wall(), Random::new(90));
    let rays: [Ray; 64] = std::array::from_fn(|_| bounce(&wall, &mut random));
    (0..count as usize).map(|k| next(&wall, &rays[k % 64])).sum()
}
