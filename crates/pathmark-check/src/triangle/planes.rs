//! Ray-plane intersection.

use crate::bare_scene::{intersect, scene_of, searches};
use crate::math::{Frame, Ray, Vec3, dot};
use crate::random::Random;
use crate::refusals::refuses_shape;
use crate::scene::{Plane, Primitive, Primitives, Scene, SurfaceOrigin};
use crate::stage::{ANY_CAMERA, DIFFUSE, named, try_scene};
use crate::{Trials, U};

const UP: Vec3 = Vec3::new(0.0, 1.0, 0.0);

fn floor(normal: Vec3) -> Plane {
    Plane { point: Vec3::new(0.0, 0.0, 0.0), normal }
}

fn scene(plane: Plane) -> Scene {
    scene_of(Primitives { planes: vec![plane], ..Primitives::default() })
}

pub(super) fn flat_angles(trials: &mut Trials) {
    // A limit of 1e-4 on the scalar product would lose the cosine 1e-5.
    for cosine in [1.0_f64, 1e-2, 1e-4, 1e-5, 1e-9, 1e-15, 1e-90] {
        for (name, scene) in searches(&scene(floor(UP))) {
            for side in [1.0, -1.0] {
                let origin = Vec3::new(0.0, side, 0.0);
                let direction = Vec3::new((1.0 - cosine * cosine).sqrt(), -side * cosine, 0.0);
                let hit = intersect(&scene, &Ray { origin, direction }, None);
                let variant = format!("cosine {cosine:e}, side {side}, accelerator {name}");
                let t = hit.map_or(f64::NAN, |hit| hit.t);
                trials.close(&variant, 1.0 / cosine, t, 4.0 * U / cosine);
                trials.same(format!("{variant}, inside"), &Some(side < 0.0), &hit.map(|hit| hit.inside));
            }
        }
    }
    tilted(trials);
}

/// Planes of any orientation: the distance is height over cosine, within the rounding of both scalar products.
fn tilted(trials: &mut Trials) {
    let rays = trials.times(100_000, 10_000_000);
    let mut random = Random::new(0x16);
    let (mut outside, mut worst) = (0, 0.0_f64);
    for _ in 0..rays {
        let normal = random.direction();
        let frame = Frame::around(normal);
        let (height, cosine) = (random.scale(-3.0, 3.0), random.scale(-5.0, 0.0));
        let direction = frame.to_world(Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, -cosine));
        let (side, point) = (if random.below(2) == 0 { 1.0 } else { -1.0 }, random.direction() * 10.0);
        let ray = Ray { origin: point + normal * (side * height), direction: direction * side };
        // Points are rounded at 10, scalar products of the directions at 1.
        let bound = (16.0 * U * (10.0 + height) + 8.0 * U * height / cosine) / cosine;
        let fraction = (Plane { point, normal }.meet(&ray, &()) - height / cosine).abs() / bound;
        worst = worst.max(fraction);
        outside += u64::from(fraction.is_nan() || fraction > 1.0);
    }
    let told = format!("{outside} of {rays}, the worst at {worst:.3} of its bound");
    trials.holds("tilted planes", "0 outside of their bounds", told, outside == 0);
}

pub(super) fn in_the_plane(trials: &mut Trials) {
    let (along, down) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, -1.0, 0.0));
    let none = [
        ("beside it, along it", [0.0, 1.0, 0.0], along),
        ("away from it", [0.0, 1.0, 0.0], UP),
        ("in it, along it", [3.0, 0.0, 4.0], along),
        ("in it, through it", [3.0, 0.0, 4.0], down),
    ];
    for (name, scene) in searches(&scene(floor(UP))) {
        for (what, origin, direction) in none {
            let hit = intersect(&scene, &Ray { origin: Vec3::from(origin), direction }, None);
            trials.same(format!("{what}, accelerator {name}"), &None, &hit);
        }
    }
    refuses_shape(
        trials,
        "{ plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 0.0] } }",
        "normal",
        "0.0, 0.0, 0.0",
    );
    refuses_shape(trials, "{ plane = { point = [0.0, 0.0, 0.0], normal = [0.0, nan, 0.0] } }", "normal", "nan");
    for normal in ["[0.0, 7.0, 0.0]", "[0.0, 1e-90, 0.0]", "[0.0, 1e90, 0.0]"] {
        let shape = format!("{{ plane = {{ point = [0.0, 0.0, 0.0], normal = {normal} }} }}");
        let read = try_scene(&[ANY_CAMERA.to_string(), named("plane", &shape, DIFFUSE, 0.0)]);
        trials.same(format!("normal {normal}"), &Some(UP), &read.ok().map(|scene| scene.primitives.planes[0].normal));
    }
    starting_on_it(trials);
}

/// A ray whose standpoint is the plane never hits it, wherever rounding has put the origin.
fn starting_on_it(trials: &mut Trials) {
    let rays = trials.times(30_000, 1_000_000);
    let mut random = Random::new(0x17);
    let mut scene = scene(floor(UP));
    let (mut again, mut started) = (0, 0);
    while started < rays {
        scene.primitives.planes[0].normal = random.direction();
        let seen = Ray { origin: random.direction() * random.scale(-3.0, 3.0), direction: random.direction() };
        let Some(hit) = intersect(&scene, &seen, None) else { continue };
        let direction = random.direction();
        let from = SurfaceOrigin { primitive: 0, inside: dot(direction, hit.normal) < 0.0 };
        again += u64::from(intersect(&scene, &Ray { origin: hit.point, direction }, Some(from)).is_some());
        started += 1;
    }
    trials.never("from tilted planes", "self-hits", again, rays);
}
