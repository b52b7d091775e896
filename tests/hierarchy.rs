//! Hierarchies find what testing every primitive finds: T13-T15, S46 and S48 of the catalogue of hard cases.

#[path = "support/bare_scene.rs"]
mod bare_scene;
#[path = "support/meshes.rs"]
mod meshes;
#[path = "support/random.rs"]
mod random;

use bare_scene::{intersect, scene_of};
use meshes::{grid_cube, star};
use pathmark::math::{Ray, Vec3, dot};
use pathmark::scene::{AllEffects, Hit, Plane, Primitive, Primitives, Scene, Sphere, Standpoint, Tests, Triangle};
use rand_pcg::Pcg64Mcg;
use random::Random;

const U: f64 = f64::EPSILON / 2.0;
const HIERARCHIES: [&str; 2] = ["median", "sah"];

fn in_cube(random: &mut Random) -> Vec3 {
    Vec3::new(2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0, 2.0 * random.unit() - 1.0)
}

fn spheres(spheres: Vec<Sphere>) -> Primitives {
    Primitives { spheres, ..Primitives::default() }
}

fn triangles(triangles: Vec<Triangle>) -> Primitives {
    Primitives { triangles, ..Primitives::default() }
}

/// A random ray, every other one at something that is there.
fn any_ray(random: &mut Random, primitives: &Primitives) -> Ray {
    let origin = in_cube(random) * random.scale(-2.0, 1.0);
    let target = match random.below(4) {
        0 if !primitives.triangles.is_empty() => {
            primitives.triangles[random.below(primitives.triangles.len())].corners[random.below(3)]
        }
        1 if !primitives.spheres.is_empty() => {
            let sphere = &primitives.spheres[random.below(primitives.spheres.len())];
            // Around its silhouette.
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
        let direction = Vec3::new(step(), step(), step());
        let length = dot(direction, direction).sqrt();
        if length > 0.0 {
            return Ray { origin, direction: direction * (1.0 / length) };
        }
    }
}

/// `rays` rays and what becomes of each after up to two scatterings, with and without a hierarchy: the same primitive and the same bits
/// of distance, and the same answer to what blocks a ray short of that distance, at it, and just beyond.
fn compare(what: &str, primitives: Primitives, rays: usize, make_ray: fn(&mut Random, &Primitives) -> Ray) {
    let all = scene_of(primitives);
    let accelerated = HIERARCHIES.map(|name| (name, all.accelerated(name).unwrap()));
    let mut random = Random(Pcg64Mcg::new(0xB0));
    let (mut traced, mut hits) = (0, 0);
    while traced < rays {
        let mut ray = make_ray(&mut random, &all.primitives);
        let mut from = None;
        for _ in 0..3 {
            let expected = intersect(&all, &ray, from);
            traced += 1;
            for (name, scene) in &accelerated {
                let found = intersect(scene, &ray, from);
                let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.primitive, hit.inside));
                assert_eq!(bits(found), bits(expected), "{what}, {name}: {ray:?} from {from:?}");
                if traced % 8 == 0 {
                    let t = expected.map_or(1.0, |hit| hit.t);
                    for limit in [t.next_down(), t, t.next_up(), 0.5 * t] {
                        let blocked =
                            |scene: &Scene| scene.is_blocked::<AllEffects>(&ray, from, limit, &mut Tests::default());
                        assert_eq!(blocked(scene), blocked(&all), "{what}, {name}: {ray:?} up to {limit}");
                        assert_eq!(blocked(scene), expected.is_some_and(|hit| hit.t < limit), "{what}, {name}");
                    }
                }
            }
            let Some(hit) = expected else { break };
            hits += 1;
            let direction = if random.below(2) == 0 {
                random.direction()
            } else {
                grid_ray(&mut random, &all.primitives).direction
            };
            from = Some(Standpoint { primitive: hit.primitive, inside: dot(direction, hit.normal) < 0.0 });
            ray = Ray { origin: hit.point, direction };
        }
    }
    assert!(hits > rays / 10, "{what}: only {hits} of {rays} hit anything");
}

/// One kind of scene has a sixth of a million rays.
const RAYS: usize = 1_000_000 / 6 + 1;

#[test]
fn random_spheres() {
    let mut random = Random(Pcg64Mcg::new(1));
    let mut all: Vec<Sphere> =
        (0..60).map(|_| Sphere { center: in_cube(&mut random), radius: random.scale(-3.0, -0.5) }).collect();
    compare("spheres", spheres(all.clone()), RAYS / 2, any_ray);
    // Walls like smallpt's, a plane, and triangles between: every kind at once.
    for axis in 0..3 {
        let mut center = [0.0; 3];
        center[axis] = 1e5 + 3.0;
        all.push(Sphere { center: Vec3::from(center), radius: 1e5 });
    }
    let planes = vec![Plane { point: Vec3::new(0.0, -2.0, 0.0), normal: Vec3::new(0.0, 1.0, 0.0) }; 2];
    let triangles = star(4, 5, || 1.5);
    compare("every kind", Primitives { spheres: all, planes, triangles, ..Primitives::default() }, RAYS / 2, any_ray);
}

#[test]
fn a_mesh() {
    let mut random = Random(Pcg64Mcg::new(2));
    compare("mesh", triangles(star(7, 9, || 0.4 + 0.6 * random.unit())), RAYS, any_ray);
}

/// Everything in one plane, which has no volume, and half of the rays from points of it.
#[test]
fn a_flat_scene() {
    let mut random = Random(Pcg64Mcg::new(3));
    let mut corner = || Vec3::new(2.0 * random.unit() - 1.0, 0.25, 2.0 * random.unit() - 1.0);
    let flat = (0..80).map(|_| corner()).map(|a| {
        let small = |v: Vec3| a + (v - a) * 0.25;
        Triangle { corners: [a, small(Vec3::new(0.9, 0.25, -0.3)), small(Vec3::new(-0.2, 0.25, 0.8))] }
    });
    compare("flat", triangles(flat.collect()), RAYS, any_ray);
}

#[test]
fn nested_spheres() {
    let center = Vec3::new(0.1, -0.2, 0.05);
    let nested = (1..=60_u32).map(|k| {
        let radius = if k % 5 == 0 { f64::from(k - 1) + libm::exp2(-40.0) } else { f64::from(k) } / 60.0;
        Sphere { center, radius }
    });
    compare("nested", spheres(nested.collect()), RAYS, any_ray);
}

/// Each primitive several times, far apart in number: the first of them must win.
#[test]
fn duplicates() {
    let mut random = Random(Pcg64Mcg::new(5));
    let balls: Vec<Sphere> = (0..9).map(|_| Sphere { center: in_cube(&mut random), radius: 0.3 }).collect();
    let mesh = star(3, 4, || 0.8);
    let mut all = Primitives::default();
    for _ in 0..3 {
        all.spheres.extend(&balls);
        all.triangles.extend(mesh.iter().rev());
    }
    compare("duplicates", all, RAYS, any_ray);
}

/// Boxes on the integers, rays along axes and diagonals from half integers: along faces, through edges and corners, from points of faces.
#[test]
fn boxes_on_a_grid() {
    let cube = grid_cube(2);
    let mut all = Vec::new();
    for corner in [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 4.0, 4.0], [1.0, 5.0, 6.0]] {
        all.extend(cube.iter().map(|t| Triangle { corners: t.corners.map(|p| p + Vec3::from(corner)) }));
    }
    compare("grid", triangles(all), RAYS, grid_ray);
}

fn same_spheres(count: usize, center: impl Fn(usize) -> [f64; 3], radius: impl Fn(usize) -> f64) -> Scene {
    let all = (0..count).map(|k| Sphere { center: Vec3::from(center(k)), radius: radius(k) });
    scene_of(spheres(all.collect()))
}

/// The traversal's stack has room for so many levels: 32 by the rule, then halves of up to 2^32.
const DEEPEST: usize = 64;

/// T14: numbers and arrangements that lead builders astray. None makes the tree deeper than the stack, and each is found again from a ray
/// at its last primitive.
#[test]
fn hard_arrangements_are_built() {
    let line = |k: usize| [k as f64, 0.0, 0.0];
    let powers = |k: usize| [libm::exp2(k as f64), 0.0, 0.0];
    let cases: [(&str, Scene); 9] = [
        ("one", same_spheres(1, line, |_| 0.4)),
        ("two", same_spheres(2, line, |_| 0.4)),
        ("65537 identical", same_spheres(65_537, |_| [1.0; 3], |_| 0.4)),
        ("1e6 duplicates", same_spheres(1_000_000, |k| line(k % 10), |_| 0.4)),
        ("concentric", same_spheres(1000, |_| [0.0; 3], |k| 1.0 + k as f64)),
        ("on a line", same_spheres(65_537, line, |_| 0.4)),
        ("on a line, each twice as far", same_spheres(300, powers, |k| 0.4 * libm::exp2(k as f64))),
        ("one huge among tiny", same_spheres(1000, line, |k| if k == 500 { 1e30 } else { 1e-3 })),
        ("powers of ten", same_spheres(180, |k| [libm::exp10(k as f64 - 90.0); 3], |_| 1e-95)),
    ];
    for (what, scene) in cases {
        for name in HIERARCHIES {
            let accelerated = scene.accelerated(name).unwrap();
            let depth = accelerated.hierarchy.as_ref().unwrap().depth();
            assert!(depth <= DEEPEST, "{what}, {name}: depth {depth}");
            let target = scene.primitives.spheres.last().unwrap();
            let origin = target.center + Vec3::new(0.0, 0.0, 2.0 * target.radius);
            let ray = Ray { origin, direction: Vec3::new(0.0, 0.0, -1.0) };
            let [found, expected] = [&accelerated, &scene].map(|scene| intersect(scene, &ray, None));
            let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.primitive));
            assert!(expected.is_some(), "{what}: the ray is aimed at a sphere");
            assert_eq!(bits(found), bits(expected), "{what}, {name}");
        }
    }
    // Nothing with a box: nothing to build, and the plane is found.
    let plane = Plane { point: Vec3::new(0.0, 0.0, 0.0), normal: Vec3::new(0.0, 1.0, 0.0) };
    let endless = scene_of(Primitives { planes: vec![plane], ..Primitives::default() });
    assert!(HIERARCHIES.iter().all(|name| endless.accelerated(name).is_none()));
}

/// A surface area heuristic that peels off one primitive at a time would be as deep as there are primitives: spheres, each half as large
/// as the one before and touching it.
#[test]
fn the_depth_is_bounded() {
    let tower =
        same_spheres(2000, |k| [libm::exp2(-(k as f64) / 8.0), 0.0, 0.0], |k| libm::exp2(-(k as f64) / 8.0 - 5.0));
    let depths = HIERARCHIES.map(|name| tower.accelerated(name).unwrap().hierarchy.unwrap().depth());
    assert!(depths.iter().all(|depth| *depth <= DEEPEST), "{depths:?}");
}

/// T15: built twice it is the same tree; with the primitives in another order the same distances are found.
#[test]
fn the_tree_depends_on_the_scene_alone() {
    let mut random = Random(Pcg64Mcg::new(15));
    let all: Vec<Sphere> =
        (0..5000).map(|_| Sphere { center: in_cube(&mut random), radius: random.scale(-3.0, -1.0) }).collect();
    let mut shuffled = all.clone();
    for k in (1..shuffled.len()).rev() {
        shuffled.swap(k, random.below(k + 1));
    }
    let (all, shuffled) = (scene_of(spheres(all)), scene_of(spheres(shuffled)));
    for name in HIERARCHIES {
        let tree = all.accelerated(name).unwrap();
        assert_eq!(tree.hierarchy, all.accelerated(name).unwrap().hierarchy, "{name}");
        let other = shuffled.accelerated(name).unwrap();
        for _ in 0..20_000 {
            let ray = any_ray(&mut random, &all.primitives);
            let (one, two) = (intersect(&tree, &ray, None), intersect(&other, &ray, None));
            assert_eq!(one.map(|hit| hit.t), two.map(|hit| hit.t), "{name}: {ray:?}");
        }
    }
}

/// S46: what leaves a sphere outwards does not meet it again, and what leaves it inwards meets it after a chord, from every point of spheres
/// of 1e-6 to 1e8 at 1e-8 to 1e8, as `from` says where it starts.
#[test]
fn no_sphere_hits_itself() {
    let mut random = Random(Pcg64Mcg::new(46));
    for _ in 0..1000 {
        let (radius, away) = (random.scale(-6.0, 8.0), random.scale(-8.0, 8.0));
        let sphere = Sphere { center: random.direction() * away, radius };
        let scene = scene_of(spheres(vec![sphere])).accelerated("sah").unwrap();
        for _ in 0..1000 {
            let normal = random.direction();
            let origin = sphere.center + normal * radius;
            let mut direction = random.direction();
            if dot(direction, sphere.normal(origin)) < 0.0 {
                direction = -direction;
            }
            let leaves = |direction: Vec3, inside: bool| {
                let standpoint = Standpoint { primitive: 0, inside };
                intersect(&scene, &Ray { origin, direction }, Some(standpoint)).map(|hit| hit.t)
            };
            assert_eq!(leaves(direction, false), None, "{sphere:?} {normal:?} {direction:?}");
            // The origin is a rounded point, so the chord is known to the rounding of its coordinates.
            let chord = 2.0 * radius * dot(normal, direction);
            let error = (leaves(-direction, true).unwrap_or(0.0) - chord).abs();
            assert!(error <= 32.0 * U * (away + radius), "{sphere:?} {normal:?} {direction:?}: off by {error:e}");
        }
    }
}
