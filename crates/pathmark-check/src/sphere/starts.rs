//! Rays that start on a surface. The program moves no origin and has no epsilon: a ray remembers the primitive and the side that it leaves.

use crate::bare_scene::{intersect, scene_of, scene_of_spheres, searches};
use crate::math::{Ray, Vec3, dot};
use crate::meshes::star;
use crate::random::Random;
use crate::scene::{Plane, Primitives, Scene, Sphere, SurfaceOrigin, Triangle};
use crate::{Trials, U};
use std::collections::BTreeMap;

/// A ray that leaves a sphere outwards must not hit it again. A ray that leaves it inwards must hit it after a chord.
pub(super) fn leaving(trials: &mut Trials) {
    let spheres = trials.times(60, 10_000);
    let rays = spheres * 1000;
    let mut random = Random::new(46);
    let mut tallies: BTreeMap<&str, [u64; 2]> = BTreeMap::new();
    for _ in 0..spheres {
        let (radius, away) = (random.scale(-6.0, 8.0), random.scale(-8.0, 8.0));
        let sphere = Sphere { center: random.direction() * away, radius };
        let alone = scene_of_spheres(vec![sphere]);
        for (name, scene) in searches(&alone) {
            let [again, off] = tallies.entry(name).or_default();
            for _ in 0..1000 {
                let (normal, any) = (random.direction(), random.direction());
                let origin = sphere.center + normal * radius;
                let outwards = if dot(any, normal) < 0.0 { -any } else { any };
                let leave = |direction: Vec3, inside: bool| {
                    let standpoint = SurfaceOrigin { primitive: 0, inside };
                    intersect(&scene, &Ray { origin, direction }, Some(standpoint)).map(|hit| hit.t)
                };
                *again += u64::from(leave(outwards, false).is_some());
                // The origin is a rounded point, so the exact chord is known only to the rounding of its coordinates.
                let chord = 2.0 * radius * dot(normal, outwards);
                let error = (leave(-outwards, true).unwrap_or(0.0) - chord).abs();
                *off += u64::from(error.is_nan() || error > 32.0 * U * (away + radius));
            }
        }
    }
    for (name, [again, off]) in tallies {
        trials.never(format!("outwards, accelerator {name}"), "self-hits", again, rays);
        trials.never(format!("inwards, accelerator {name}"), "chords off by more than 32 roundings", off, rays);
    }
    leaving_a_mesh(trials);
}

/// A ray that leaves a mesh hits neither its starting triangle nor a neighbour.
fn leaving_a_mesh(trials: &mut Trials) {
    let rays = trials.times(100_000, 10_000_000);
    let mesh = scene_of(Primitives { triangles: star(8, 12, || 1.0), ..Primitives::default() });
    for (name, mesh) in searches(&mesh) {
        let mut random = Random::new(8);
        let (mut left, mut again) = (0, 0);
        while left < rays {
            let origin = random.direction() * random.scale(0.5, 3.0);
            let direction = (random.direction() * random.unit() - origin).normalized();
            let Some(hit) = intersect(&mesh, &Ray { origin, direction }, None) else { continue };
            let mut direction = random.direction();
            if dot(direction, hit.normal) < 0.0 {
                direction = -direction;
            }
            let standpoint = SurfaceOrigin { primitive: hit.primitive, inside: false };
            again += u64::from(intersect(&mesh, &Ray { origin: hit.point, direction }, Some(standpoint)).is_some());
            left += 1;
        }
        trials.never(format!("a convex mesh, accelerator {name}"), "self-hits", again, rays);
    }
}

/// For each kind of surface, a scene of one through `x`, facing along the x axis, and a second one `gap` farther.
fn pairs(x: f64, gap: f64) -> [(&'static str, Scene); 3] {
    let towards = Vec3::new(1.0, 0.0, 0.0);
    let sphere = |x: f64| Sphere { center: Vec3::new(x - 1.0, 0.0, 0.0), radius: 1.0 };
    let plane = |x: f64| Plane { point: Vec3::new(x, 0.0, 0.0), normal: towards };
    let corners = |x: f64| [Vec3::new(x, -1.0, -1.0), Vec3::new(x, 1.0, -1.0), Vec3::new(x, 0.0, 1.0)];
    let triangle = |x: f64| Triangle { corners: corners(x) };
    let none = Primitives::default;
    [
        ("spheres", scene_of_spheres(vec![sphere(x), sphere(x + gap)])),
        ("planes", scene_of(Primitives { planes: vec![plane(x), plane(x + gap)], ..none() })),
        ("triangles", scene_of(Primitives { triangles: vec![triangle(x), triangle(x + gap)], ..none() })),
    ]
}

/// The offset of Wächter and Binder (Ray Tracing Gems, 2019, ch. 6) changes its rule at 1/32 and adds integers to the
/// bits of coordinates: at 0 the sign flips. Here a ray starts where the last one ended, so these points are not
/// special, and a surface nearer than any offset is hit.
pub(super) fn awkward_points(trials: &mut Trials) {
    let limit = 1.0_f64 / 32.0;
    let points = [0.0, limit, limit.next_down(), limit.next_up(), 5e-324, 1.0, 3.0];
    let mut tallies: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    for (x, gap) in points.into_iter().flat_map(|x| [-x, x]).flat_map(|x| [(x, 1e-3), (x, libm::exp2(-40.0))]) {
        for (kind, scene) in pairs(x, gap) {
            for (name, scene) in searches(&scene) {
                let [back, ahead] = [-1.0, 1.0].map(|side| {
                    let ray = Ray { origin: Vec3::new(x, 0.0, 0.0), direction: Vec3::new(side, 0.0, 0.0) };
                    let from = SurfaceOrigin { primitive: 0, inside: side < 0.0 };
                    intersect(&scene, &ray, Some(from))
                });
                let error = ahead.filter(|hit| hit.primitive == 1).map_or(f64::NAN, |hit| hit.t - ((x + gap) - x));
                // The far sides of both spheres lie behind the origin; the flat surfaces have nothing there.
                let is_right_behind = back.map_or(kind != "spheres", |hit| kind == "spheres" && hit.t > 1.9);
                let (wrong, tried) = tallies.entry(format!("{kind}, accelerator {name}")).or_default();
                *wrong += u64::from(!(is_right_behind && error.abs() <= 4.0 * U * (2.0 + x.abs())));
                *tried += 1;
            }
        }
    }
    for (variant, (wrong, tried)) in tallies {
        trials.never(variant, "own surfaces met or second ones missed", wrong, tried);
    }
}

pub(super) fn nearest_then_lowest(trials: &mut Trials) {
    let concentric = |radii: &[f64]| {
        let sphere = |radius: &f64| Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: *radius };
        scene_of_spheres(radii.iter().map(sphere).collect())
    };
    let thin = concentric(&[1.0, 1.0 + libm::exp2(-40.0)]);
    let identical = concentric(&[0.5, 1.0, 1.0, 1.0]);
    let rays = trials.times(1000, 1_000_000);
    for (what, scene, from_outside, from_inside) in [("thin shell", thin, 1, 0), ("identical", identical, 1, 1)] {
        for (name, scene) in searches(&scene) {
            let mut random = Random::new(48);
            let seen = |scene: &Scene, ray: &Ray| intersect(scene, ray, None).map(|hit| hit.primitive);
            let wrong = (0..rays).filter(|_| {
                let out = random.direction();
                let inwards = Ray { origin: out * 3.0, direction: -out };
                let outwards = Ray { origin: out * 0.9, direction: out };
                (seen(&scene, &inwards), seen(&scene, &outwards)) != (Some(from_outside), Some(from_inside))
            });
            let wrong = wrong.count() as u64;
            trials.never(format!("{what}, accelerator {name}"), "another sphere than the first", wrong, rays);
        }
    }
}
