//! Hierarchies compared with testing every primitive: the same primitive and the same bits of distance.

use crate::Trials;
use crate::bare_scene::{intersect, scene_of, searches};
use crate::math::{Ray, Vec3, dot};
use crate::meshes::{grid_cube, star};
use crate::random::Random;
use crate::scene::{Hit, Plane, Primitives, Scene, Sphere, SurfaceOrigin, Triangle};

/// A generator of rays for a scene.
type MakeRay = fn(&mut Random, &Primitives) -> Ray;

pub(super) fn in_cube(random: &mut Random) -> Vec3 {
    Vec3::new(2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0)
}

/// A random ray; about every other one aims at a primitive.
pub(super) fn any_ray(random: &mut Random, primitives: &Primitives) -> Ray {
    let origin = in_cube(random) * random.scale(-2.0, 1.0);
    let target = match random.below(4) {
        0 if !primitives.triangles.is_empty() => {
            primitives.triangles[random.below(primitives.triangles.len())].corners[random.below(3)]
        }
        1 if !primitives.spheres.is_empty() => {
            let sphere = &primitives.spheres[random.below(primitives.spheres.len())];
            // Near its silhouette.
            sphere.center + random.direction() * sphere.radius
        }
        _ => origin + random.direction(),
    };
    Ray { origin, direction: (target - origin).normalized() }
}

/// A ray along an axis or a diagonal from a point whose coordinates are multiples of one half.
fn grid_ray(random: &mut Random, _primitives: &Primitives) -> Ray {
    let mut half = || random.below(21) as f64 / 2.0 - 1.0;
    let origin = Vec3::new(half(), half(), half());
    loop {
        let mut step = || [-1.0, -0.0, 0.0, 1.0][random.below(4)];
        let direction: Vec3 = Vec3::new(step(), step(), step());
        let length = dot(direction, direction).sqrt();
        if length > 0.0 {
            return Ray { origin, direction: direction * (1.0 / length) };
        }
    }
}

pub(super) fn every_kind(trials: &mut Trials) {
    let rays = trials.times(60_000, 10_000_000) / 6;
    for (what, primitives, make_ray) in arrangements() {
        let all = scene_of(primitives);
        for (name, accelerated) in searches(&all).filter(|(_, scene)| scene.hierarchy.is_some()) {
            let Tally { traced, hits, differ, blocked_otherwise } = compare(&all, &accelerated, rays, make_ray);
            let variant = format!("{what}, accelerator {name}");
            trials.never(&variant, "hits with other bits", differ, traced);
            trials.never(&variant, "other answers to what is in the way", blocked_otherwise, traced);
            let told = format!("{hits} of {traced}");
            trials.holds(&variant, "a tenth of the rays hit, or they prove nothing", told, hits * 10 > traced);
        }
    }
}

#[derive(Default)]
struct Tally {
    traced: u64,
    hits: u64,
    differ: u64,
    blocked_otherwise: u64,
}

/// Follows so many rays, each through up to two scatterings. Both scenes must give the same primitive, the same bits
/// of distance, and the same answer to whether a ray is blocked before that distance, at it, and just beyond.
fn compare(all: &Scene, accelerated: &Scene, rays: u64, make_ray: MakeRay) -> Tally {
    let mut random = Random::new(0xB0);
    let mut tally = Tally::default();
    while tally.traced < rays {
        let mut ray = make_ray(&mut random, &all.primitives);
        let mut from = None;
        for _ in 0..3 {
            let expected = intersect(all, &ray, from);
            tally.traced += 1;
            let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.primitive, hit.inside));
            tally.differ += u64::from(bits(intersect(accelerated, &ray, from)) != bits(expected));
            if tally.traced % 8 == 0 {
                let t = expected.map_or(1.0, |hit| hit.t);
                let is_otherwise = [t.next_down(), t, t.next_up(), 0.5 * t].into_iter().any(|limit| {
                    let blocked = |scene: &Scene| scene.is_blocked_by_any(&ray, from, limit);
                    let nearer = expected.is_some_and(|hit| hit.t < limit);
                    blocked(all) != nearer || blocked(accelerated) != nearer
                });
                tally.blocked_otherwise += u64::from(is_otherwise);
            }
            let Some(hit) = expected else { break };
            tally.hits += 1;
            let on_grid = random.below(2) == 0;
            let direction = if on_grid { grid_ray(&mut random, &all.primitives).direction } else { random.direction() };
            from = Some(SurfaceOrigin { primitive: hit.primitive, inside: dot(direction, hit.normal) < 0.0 });
            ray = Ray { origin: hit.point, direction };
        }
    }
    tally
}

/// Six kinds of scenes, each with its generator of rays.
fn arrangements() -> Vec<(&'static str, Primitives, MakeRay)> {
    let none = Primitives::default;
    let mut random = Random::new(13);
    let mesh = star(7, 9, || 0.4 + 0.6 * random.unit());
    let small: Vec<Sphere> =
        (0..60).map(|_| Sphere { center: in_cube(&mut random), radius: random.scale(-3.0, -0.5) }).collect();
    // Walls like smallpt's, planes, and triangles between them.
    let walls = [[1e5 + 3.0, 0.0, 0.0], [0.0, 1e5 + 3.0, 0.0], [0.0, 0.0, 1e5 + 3.0]];
    let walls = walls.map(|center| Sphere { center: Vec3::from(center), radius: 1e5 });
    let mixed = Primitives {
        spheres: small.into_iter().chain(walls).collect(),
        planes: vec![Plane { point: Vec3::new(0.0, -2.0, 0.0), normal: Vec3::new(0.0, 1.0, 0.0) }; 2],
        triangles: star(4, 5, || 1.5),
        ..none()
    };
    // Triangles in one plane, so that their bounding box has no volume.
    let flat = (0..80).map(|_| {
        let a = Vec3::new(2.0 * random.unit() - 1.0, 0.25, 2.0 * random.unit() - 1.0);
        let near = |v: Vec3| a + (v - a) * 0.25;
        Triangle { corners: [a, near(Vec3::new(0.9, 0.25, -0.3)), near(Vec3::new(-0.2, 0.25, 0.8))] }
    });
    let flat = flat.collect();
    let nested = (1..=60_u32).map(|k| {
        let radius = if k % 5 == 0 { f64::from(k - 1) + libm::exp2(-40.0) } else { f64::from(k) } / 60.0;
        Sphere { center: Vec3::new(0.1, -0.2, 0.05), radius }
    });
    // Each primitive several times, with distant indices: the first one must win.
    let mut repeated = none();
    let balls: Vec<Sphere> = (0..9).map(|_| Sphere { center: in_cube(&mut random), radius: 0.3 }).collect();
    for _ in 0..3 {
        repeated.spheres.extend(&balls);
        repeated.triangles.extend(star(3, 4, || 0.8).iter().rev());
    }
    // Boxes with integer corners: rays run along faces, through edges and corners, and from points of faces.
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 4.0, 4.0], [1.0, 5.0, 6.0]].map(Vec3::from);
    let moved = |by: Vec3| grid_cube(2).into_iter().map(move |t| Triangle { corners: t.corners.map(|p| p + by) });
    let boxes = corners.into_iter().flat_map(moved).collect();
    vec![
        ("every kind", mixed, any_ray),
        ("mesh", Primitives { triangles: mesh, ..none() }, any_ray),
        ("flat", Primitives { triangles: flat, ..none() }, any_ray),
        ("nested", Primitives { spheres: nested.collect(), ..none() }, any_ray),
        ("repeated", repeated, any_ray),
        ("grid", Primitives { triangles: boxes, ..none() }, grid_ray),
    ]
}
