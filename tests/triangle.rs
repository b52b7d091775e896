//! Ray against triangle: T01-T08 of the catalogue of hard cases.

#[path = "support/bare_scene.rs"]
mod bare_scene;
#[path = "support/double_double.rs"]
mod double_double;
#[path = "support/meshes.rs"]
mod meshes;
#[path = "support/random.rs"]
mod random;

use bare_scene::{intersect, scene_of};
use double_double::{Dd, two_product};
use meshes::{grid_cube, star};
use pathmark::math::{Ray, Vec3, dot};
use pathmark::scene::{Primitive, Primitives, Scene, Standpoint, Triangle};
use rand_pcg::Pcg64Mcg;
use random::Random;

const U: f64 = f64::EPSILON / 2.0;

fn triangle(corners: [[f64; 3]; 3]) -> Triangle {
    Triangle { corners: corners.map(Vec3::from) }
}

fn meet(triangle: &Triangle, ray: &Ray) -> Option<f64> {
    Some(triangle.meet(ray, &Triangle::prepare(ray))).filter(|t| *t > 0.0)
}

fn scene(triangles: Vec<Triangle>) -> Scene {
    scene_of(Primitives { triangles, ..Primitives::default() })
}

/// A ray of length 1 towards a point.
fn towards(origin: Vec3, target: Vec3) -> Ray {
    Ray { origin, direction: (target - origin).normalized() }
}

/// T01: through the diagonal that two triangles share: both are hit, so the first is reported.
#[test]
fn the_diagonal_of_a_quad_belongs_to_its_first_half() {
    let [a, b, c, d] = [[-5.0, -5.0, 0.0], [5.0, -5.0, 0.0], [5.0, 5.0, 0.0], [-5.0, 5.0, 0.0]];
    let single = |x: f64| f64::from(x as f32);
    let direction = Vec3::new(single(0.304_584_47), single(0.304_584_47), single(-0.902_472_5));
    let ray = Ray { origin: Vec3::new(0.0, 0.0, 10.0), direction };
    for halves in [[[a, b, c], [a, c, d]], [[a, c, d], [a, b, c]]] {
        let scene = scene(halves.map(triangle).to_vec());
        assert!(scene.primitives.triangles.iter().all(|half| meet(half, &ray).is_some()));
        let hit = intersect(&scene, &ray, None).expect("a hit");
        assert_eq!(hit.primitive, 0);
        let off = hit.point - Vec3::new(3.375, 3.375, 0.0);
        assert!(dot(off, off).sqrt() < 1e-6, "{:?}", hit.point);
    }
}

/// T02: rays from inside a closed mesh at points of its edges and at its vertices meet it, every one: through the hierarchy, and one in
/// sixteen against every triangle. A million, or with `PATHMARK_THOROUGH` set ten.
#[test]
fn a_closed_mesh_has_no_gap() {
    let rays = if std::env::var_os("PATHMARK_THOROUGH").is_some() { 10_000_000 } else { 1_000_000 };
    let mut random = Random(Pcg64Mcg::new(0x51A2));
    let spiky = star(16, 16, || 0.5 + random.unit());
    let mut random = Random(Pcg64Mcg::new(0x51A3));
    for (triangles, stretch, away) in
        [(spiky, 1.0, 0.2), (star(10, 20, || 1.0), 1000.0, 0.9), (star(5, 7, || 1.0), 1e-6, 1e-9)]
    {
        let triangles: Vec<Triangle> = triangles.iter().map(|triangle| triangle.scaled(stretch)).collect();
        let all = scene(triangles.clone());
        let accelerated = all.accelerated("sah").unwrap();
        for k in 0..rays / 3 {
            let [a, b, _] = triangles[random.below(triangles.len())].corners;
            let target = if random.below(4) == 0 { a } else { a + (b - a) * random.unit() };
            let ray = towards(random.direction() * (away * random.unit() * stretch * 0.5), target);
            let hit = intersect(&accelerated, &ray, None);
            assert!(hit.is_some(), "ray {k} passes between: {ray:?}");
            if k % 16 == 0 {
                assert_eq!(hit, intersect(&all, &ray, None), "{ray:?}");
            }
        }
    }
}

/// T03: the same where everything is an integer: along the axes from integer points, through vertices and edges, the way is an integer.
#[test]
fn integer_vertices_are_hit_exactly() {
    const N: i32 = 8;
    let all = scene(grid_cube(N));
    let accelerated = all.accelerated("sah").unwrap();
    for (x, y, z) in (1..2 * N).flat_map(|x| (1..2 * N).flat_map(move |y| [3, 8].map(move |z| (x, y, z)))) {
        let origin = [x, y, z].map(|halves| f64::from(halves) / 2.0);
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut direction = [0.0 * sign; 3];
                direction[axis] = sign;
                let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction) };
                let way = if sign < 0.0 { origin[axis] } else { f64::from(N) - origin[axis] };
                for scene in [&all, &accelerated] {
                    assert_eq!(intersect(scene, &ray, None).map(|hit| hit.t), Some(way), "{ray:?}");
                }
            }
        }
    }
}

/// T04 and T05: without an area there is nothing to hit, whatever the ray, and with the smallest and largest areas there is.
#[test]
fn only_a_triangle_with_an_area_is_hit() {
    // pbrt's `Triangle.BadCases`: single-precision corners on a line, and a ray as long as its segment.
    let bad = triangle([
        [-1_113.454_59, -79.049_614, -56.243_190_8],
        [-1_113.454_59, -87.092_269_9, -56.243_190_8],
        [-1_113.454_59, -79.209_014_9, -56.243_190_8],
    ]);
    let (origin, direction) =
        ([-1_081.479_25, 99.999_954_2, 87.770_111_1], [-32.107_299_8, -183.355_865, -144.607_635]);
    let ray = Ray { origin: Vec3::from(origin), direction: Vec3::from(direction) };
    assert!(bad.is_degenerate() && meet(&bad, &ray).is_none());

    let (p, q) = ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]);
    let mut random = Random(Pcg64Mcg::new(5));
    for corners in [[p, p, p], [p, p, q], [p, q, p], [q, p, p], [[1.0; 3], [2.0; 3], [4.0; 3]]] {
        let line = triangle(corners);
        assert!(line.is_degenerate(), "{line:?}");
        for _ in 0..1000 {
            let ray = towards(random.direction() * 10.0, random.direction());
            assert!(meet(&line, &ray).is_none(), "{line:?} {ray:?}");
        }
        // Where all three lie apart on a line, rounding decides; the reader lets none of them in.
        for at in
            corners.iter().filter(|_| corners[0] == corners[1] || corners[1] == corners[2] || corners[0] == corners[2])
        {
            let ray = towards(Vec3::new(-3.0, 4.0, 5.0), Vec3::from(*at));
            assert!(meet(&line, &ray).is_none(), "{line:?} at a corner");
        }
    }
    for size in [1e-90, 1e-20, 1.0, 1e15, 1e90] {
        let triangle = triangle([[0.0, 0.0, size], [size, 0.0, size], [0.0, size, size]]);
        assert!(!triangle.is_degenerate(), "{size:e}");
        let ray = towards(Vec3::new(0.25 * size, 0.25 * size, 0.0), Vec3::new(0.25 * size, 0.25 * size, size));
        let t = meet(&triangle, &ray).expect("a hit");
        assert!((t - size).abs() <= 4.0 * U * size, "{size:e}: {t:e}");
        assert_eq!(triangle.normal(ray.at(size)), Vec3::new(0.0, 0.0, 1.0), "{size:e}");
    }
}

/// T06: a ray in the plane of a triangle meets nothing, whichever way its corners run.
#[test]
fn edge_on_there_is_nothing() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let [a, b, c] = corners;
    for triangle in [triangle([a, b, c]), triangle([a, c, b])] {
        for origin in [[-1.0, 0.25, 0.0], [0.25, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.1, 0.1, 0.0]] {
            for target in [[0.25, 0.25, 0.0], [1.0, 0.25, 0.0], [0.25, 1.0, 0.0], [0.0, 0.0, 0.0]] {
                let ray = towards(Vec3::from(origin), Vec3::from(target));
                assert_eq!(meet(&triangle, &ray), None, "{origin:?} to {target:?}");
            }
        }
    }
}

/// Distance to a triangle's plane, in double-double numbers from the exact corners: n·(a - o) / n·d with n = (b - a) x (c - a), all of
/// whose differences are split into what is exact. Also the cosine between normal and direction.
fn exact_distance(triangle: &Triangle, ray: &Ray) -> (f64, f64) {
    let one = |x: f64| two_product(x, 1.0);
    let [a, b, c] = triangle.corners.map(|p| [one(p.x), one(p.y), one(p.z)]);
    let [o, d] = [ray.origin, ray.direction].map(|p| [one(p.x), one(p.y), one(p.z)]);
    let minus = |p: [Dd; 3], q: [Dd; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let product = |p: [Dd; 3], q: [Dd; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (e, f) = (minus(b, a), minus(c, a));
    let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
    let (across, along) = (product(n, minus(a, o)), product(n, d));
    (across.over(along), along.0.abs() / product(n, n).sqrt().0)
}

/// T07: distances to triangles from 1e-6 across a million away to 1e9 across, within gamma(7) of the largest coordinate over the cosine
/// at which the plane is met.
#[test]
fn distances_are_exact_to_seven_roundings() {
    let gamma = 7.0 * U / (1.0 - 7.0 * U);
    let mut random = Random(Pcg64Mcg::new(0x7707));
    let mut hits = 0;
    for _ in 0..200_000 {
        let (size, away) = match random.below(4) {
            0 => (1e-6, 1e6),
            1 => (1e9, 1e9),
            2 => (1.0, random.scale(-3.0, 6.0)),
            _ => (random.scale(-6.0, 9.0), random.scale(-6.0, 9.0)),
        };
        let middle = random.direction() * away;
        let triangle = Triangle { corners: [0; 3].map(|_| middle + random.direction() * size) };
        let [a, b, c] = triangle.corners;
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let target = a + (b - a) * u + (c - a) * v;
        let ray = towards(random.direction() * random.scale(-3.0, 3.0), target);
        let (expected, cosine) = exact_distance(&triangle, &ray);
        if triangle.is_degenerate() || cosine < 0.01 {
            continue;
        }
        let Some(t) = meet(&triangle, &ray) else { continue };
        hits += 1;
        let largest = triangle.corners.iter().chain([&ray.origin]).flat_map(|p| [p.x.abs(), p.y.abs(), p.z.abs()]);
        let bound = gamma * largest.fold(0.0, f64::max) / cosine;
        assert!((t - expected).abs() <= bound, "{triangle:?} {ray:?}: {t} instead of {expected}, bound {bound:e}");
    }
    assert!(hits > 150_000, "{hits}");
}

/// T08: both sides are seen; the outside is where the corners run counterclockwise.
#[test]
fn triangles_have_two_sides() {
    let flat = scene(vec![triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])]);
    for (z, inside) in [(2.0, false), (-2.0, true)] {
        let ray = towards(Vec3::new(0.25, 0.25, z), Vec3::new(0.25, 0.25, 0.0));
        let hit = intersect(&flat, &ray, None).expect("a hit");
        assert_eq!((hit.t, hit.inside, hit.normal), (2.0, inside, Vec3::new(0.0, 0.0, 1.0)));
    }
}

/// A ray that leaves a convex mesh from a point of it meets nothing: neither the triangle that it starts on nor a neighbour.
#[test]
fn what_leaves_a_convex_mesh_does_not_meet_it() {
    let mut random = Random(Pcg64Mcg::new(0x08));
    let ball = scene(star(8, 12, || 1.0)).accelerated("sah").unwrap();
    let mut left = 0;
    while left < 300_000 {
        let seen = towards(random.direction() * random.scale(0.5, 3.0), random.direction() * random.unit());
        let Some(hit) = intersect(&ball, &seen, None) else { continue };
        let mut direction = random.direction();
        if dot(direction, hit.normal) < 0.0 {
            direction = -direction;
        }
        let ray = Ray { origin: hit.point, direction };
        let again = intersect(&ball, &ray, Some(Standpoint { primitive: hit.primitive, inside: false }));
        assert_eq!(again, None, "{ray:?}");
        left += 1;
    }
}
