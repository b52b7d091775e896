//! Ray against plane: T16 and T17 of the catalogue of hard cases.

#[path = "support/bare_scene.rs"]
mod bare_scene;
#[path = "support/random.rs"]
mod random;

use bare_scene::{intersect, scene_of};
use pathmark::math::{Frame, Ray, Vec3, dot};
use pathmark::scene::{Plane, Primitive, Primitives, Scene, Standpoint};
use rand_pcg::Pcg64Mcg;
use random::Random;

const U: f64 = f64::EPSILON / 2.0;
const UP: Vec3 = Vec3::new(0.0, 1.0, 0.0);

fn floor(normal: Vec3) -> Plane {
    Plane { point: Vec3::new(0.0, 0.0, 0.0), normal }
}

fn scene(plane: Plane) -> Scene {
    scene_of(Primitives { planes: vec![plane], ..Primitives::default() })
}

/// T16: a plane is met at every angle and from both sides: at a cosine of 1e-5, where report C's limit of 1e-4 loses it, and far flatter.
#[test]
fn no_angle_is_too_flat() {
    for cosine in [1.0_f64, 1e-2, 1e-4, 1e-5, 1e-9, 1e-15, 1e-90] {
        for side in [1.0, -1.0] {
            let origin = Vec3::new(0.0, side, 0.0);
            let direction = Vec3::new((1.0 - cosine * cosine).sqrt(), -side * cosine, 0.0);
            let hit = intersect(&scene(floor(UP)), &Ray { origin, direction }, None).expect("a hit");
            assert!((hit.t - 1.0 / cosine).abs() <= 4.0 * U / cosine, "cosine {cosine:e}: {}", hit.t);
            assert_eq!(hit.inside, side < 0.0, "cosine {cosine:e}");
        }
    }
}

/// T16 for planes that lie anyhow: height over cosine, within the rounding of both scalar products.
#[test]
fn tilted_planes_are_met_where_geometry_says() {
    let mut random = Random(Pcg64Mcg::new(0x16));
    for _ in 0..100_000 {
        let normal = random.direction();
        let frame = Frame::around(normal);
        let (height, cosine) = (random.scale(-3.0, 3.0), random.scale(-5.0, 0.0));
        let direction = frame.to_world(Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine));
        let (side, point) = (if random.below(2) == 0 { 1.0 } else { -1.0 }, random.direction() * 10.0);
        let ray = Ray { origin: point + normal * (side * height), direction: direction * side };
        let t = Plane { point, normal }.meet(&ray, &());
        // Points are rounded at 10, the directions' products at 1.
        let bound = (16.0 * U * (10.0 + height) + 8.0 * U * height / cosine) / cosine;
        assert!((t - height / cosine).abs() <= bound, "height {height} cosine {cosine:e}: {t}, bound {bound:e}");
    }
}

/// T17: what starts on the plane, runs in it or leaves it does not meet it.
#[test]
fn in_the_plane_there_is_nothing() {
    let scene = scene(floor(UP));
    let along = Vec3::new(0.6, 0.0, 0.8);
    let down = Vec3::new(0.0, -1.0, 0.0);
    let none = [([0.0, 1.0, 0.0], along), ([0.0, 1.0, 0.0], UP), ([3.0, 0.0, 4.0], along), ([3.0, 0.0, 4.0], down)];
    for (origin, direction) in none {
        assert_eq!(intersect(&scene, &Ray { origin: Vec3::from(origin), direction }, None), None, "{origin:?}");
    }
    // A ray that starts on it by name never sees it, wherever rounding has put its origin.
    let mut random = Random(Pcg64Mcg::new(0x17));
    for _ in 0..300_000 {
        let tilted = floor(random.direction());
        let scene = self::scene(tilted);
        let seen = Ray { origin: random.direction() * random.scale(-3.0, 3.0), direction: random.direction() };
        let Some(hit) = intersect(&scene, &seen, None) else { continue };
        let direction = random.direction();
        let inside = dot(direction, tilted.normal) < 0.0;
        let ray = Ray { origin: hit.point, direction };
        assert_eq!(intersect(&scene, &ray, Some(Standpoint { primitive: 0, inside })), None);
    }
}
