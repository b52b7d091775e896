//! Geometry of whole scenes: no epsilon, no leak, no dependence on scale. S40-S43, S48, S60-S64 of the catalogue of hard cases.

#[path = "support/scene_text.rs"]
mod scene_text;

use pathmark::kernel::Spec;
use pathmark::material::Material;
use pathmark::math::{Frame, Ray, Rgb, Vec3, dot};
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::sampling::{Address, Purpose, SampleKey};
use pathmark::sampling::{Independent, Sampler};
use pathmark::scene::{AllEffects, Hit, Scene, Standpoint, Tests, load};
use scene_text::{Ball, load_scene};
use std::sync::Arc;

const DIFFUSE: &str = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }";
const MIRROR: &str = "{ mirror = { albedo = [1.0, 1.0, 1.0] } }";
const GLASS: &str = "{ dielectric = { eta = 1.5, tint = [1.0, 1.0, 1.0] } }";

fn ball(center: [f64; 3], radius: f64, material: &str) -> Ball {
    Ball { center, radius, material: material.to_string(), emission: [0.0; 3] }
}

fn render(scene: Scene, estimator: &str, (width, height): (u32, u32), spp: u32) -> Outcome {
    let spec = Spec { width, height, seed: 7, estimator: estimator.into(), ..Spec::default() };
    let (decomposition, strategy) = ("rows".into(), "shared-counter".into());
    let settings = Settings { spp, spec, decomposition, strategy, threads: 2, ..Settings::default() };
    Setup::for_scene(Arc::new(scene), settings).unwrap().run(None).unwrap()
}

fn intersect(scene: &Scene, ray: &Ray, from: Option<Standpoint>) -> Option<Hit> {
    scene.intersect::<AllEffects>(ray, from, &mut Tests::default())
}

/// Two uniform numbers for draw `k` of the test at hand.
fn uniform(k: u32) -> [f64; 2] {
    let key = SampleKey { seed: 11, pixel: k, sample: 0 };
    Independent.pair(Address { key, bounce: 0, branch: 0, purpose: Purpose::Film })
}

/// Where a ray that arrives along `direction` goes when the surface takes `u`; the new direction is not normalised.
fn scatter(scene: &Scene, hit: &Hit, direction: Vec3, u: f64) -> (Ray, Standpoint) {
    let frame = Frame::around(if hit.inside { -hit.normal } else { hit.normal });
    let wo = frame.to_local(-direction);
    let material: &Material = &scene.objects[hit.object as usize].material;
    let wi = material.sample::<AllEffects>(wo, hit.inside, [u, 0.5]).expect("no absorption").wi;
    let inside = (wi.z < 0.0) != hit.inside;
    (Ray { origin: hit.point, direction: frame.to_world(wi) }, Standpoint { primitive: hit.primitive, inside })
}

/// S40: through a lone glass ball of radius 4e-5 and 1e-6, smaller than any usual epsilon, and one of 16.5: the same lengths in radii.
#[test]
fn a_tiny_glass_ball_is_a_rescaled_big_one() {
    let walk = |scene: &Scene, radius: f64, k: u32| {
        let [u, v] = uniform(k);
        // Impact parameter up to 0.99 of the radius: closer to the limb the lengths' own condition number passes 1e3.
        let (sin, cos) = (libm::sin(std::f64::consts::TAU * u), libm::cos(std::f64::consts::TAU * u));
        let impact = 0.99 * v.sqrt() * radius;
        let origin = Vec3::new(impact * cos, impact * sin, 5.0 * radius);
        let mut ray = Ray { origin, direction: Vec3::new(0.0, 0.0, -1.0) };
        let mut from = None;
        let mut lengths = Vec::new();
        // In by refraction, once around inside by reflection, out by refraction, on to the wall.
        for u in [0.99, 0.0, 0.99, 0.0] {
            let hit = intersect(scene, &ray, from).expect("the scene is closed");
            lengths.push(hit.t / radius);
            let (next, standpoint) = scatter(scene, &hit, ray.direction, u);
            (ray, from) = (Ray { direction: next.direction.normalized(), ..next }, Some(standpoint));
        }
        lengths
    };
    let scene = |radius: f64| {
        load_scene([0.0; 3], &[ball([0.0; 3], radius, GLASS), ball([0.0; 3], 10.0 * radius, DIFFUSE)]).unwrap()
    };
    let big = scene(16.5);
    for radius in [4e-5, 1e-6] {
        let tiny = scene(radius);
        for k in 0..10_000 {
            let (expected, found) = (walk(&big, 16.5, k), walk(&tiny, radius, k));
            for (e, f) in expected.iter().zip(&found) {
                assert!((e - f).abs() <= 1e-12 * e, "radius {radius:e}, ray {k}: {found:?} instead of {expected:?}");
            }
        }
    }
}

/// S40, S43 in smallpt's units: inside a ball of radius 4e-5 at (73, 40, 78) the chord is 2 r cos and ends on the ball, however flat.
#[test]
fn no_chord_is_too_short() {
    let center = Vec3::new(73.0, 40.0, 78.0);
    for radius in [16.5, 4e-5, 1e-6] {
        let scene =
            load_scene([0.0; 3], &[ball([73.0, 40.0, 78.0], radius, GLASS), ball([50.0; 3], 1e5, DIFFUSE)]).unwrap();
        for k in 0..10_000 {
            let [u, v] = uniform(k);
            let normal = Vec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.3).normalized();
            let frame = Frame::around(-normal);
            let cos = libm::exp10(-5.0 * uniform(k + 20_000)[0]);
            let direction = frame.to_world(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)).normalized();
            let ray = Ray { origin: center + normal * radius, direction };
            let hit = intersect(&scene, &ray, Some(Standpoint { primitive: 0, inside: true })).expect("closed");
            // The origin is a rounded point: its error, relative to the radius, turns the chord.
            let tolerance = 2.0 * radius * 1e-14 + 4e-14;
            let error = (hit.t - 2.0 * radius * cos).abs();
            assert!(hit.object == 0 && error <= tolerance, "radius {radius:e}, cos {cos:e}: {hit:?}, off by {error:e}");
        }
    }
}

/// S41: a scene times 2^k renders to the same bits; any absolute epsilon would show.
#[test]
fn power_of_two_scaling_changes_no_bit() {
    let cornell = load("cornell").unwrap();
    for estimator in ["smallpt", "bsdf"] {
        let expected = render(cornell.clone(), estimator, (24, 18), 8).checksum;
        for k in (-40..=40).step_by(8) {
            let scaled = cornell.scaled(libm::exp2(f64::from(k)));
            assert_eq!(scaled.primitives == cornell.primitives, k == 0, "nothing was scaled");
            assert_eq!(render(scaled, estimator, (24, 18), 8).checksum, expected, "{estimator}, 2^{k}");
        }
    }
}

/// S41 for triangles and through a hierarchy: its boxes have a padding in proportion, so they are opened for the same rays.
#[test]
fn scaling_changes_no_bit_of_triangles_and_no_box() {
    let mut furnace = load("furnace:0.6").unwrap();
    // Out of its equilibrium, in which every pixel is 1.
    for (index, object) in furnace.objects.iter_mut().enumerate() {
        object.emission = if index % 3 == 0 { Rgb::WHITE } else { Rgb::BLACK };
    }
    assert!(furnace.primitives.triangles.len() >= 12);
    for accelerator in ["none", "median", "sah"] {
        let render = |scene: Scene| {
            let accelerator = Some(accelerator.to_string());
            let spec =
                Spec { width: 24, height: 18, seed: 7, estimator: "bsdf".into(), accelerator, ..Spec::default() };
            let (decomposition, strategy) = ("rows".into(), "serial".into());
            let settings = Settings { spp: 8, spec, decomposition, strategy, threads: 1, ..Settings::default() };
            let outcome = Setup::for_scene(Arc::new(scene), settings).unwrap().run(None).unwrap();
            (outcome.checksum.unwrap(), outcome.counts)
        };
        let expected = render(furnace.clone());
        for k in (-40..=40).step_by(8) {
            assert_eq!(render(furnace.scaled(libm::exp2(f64::from(k)))), expected, "{accelerator}, 2^{k}");
        }
    }
}

/// S42: no ray of 2e7 in the closed box meets nothing.
#[test]
fn a_closed_scene_has_no_leak() {
    let outcome = render(load("cornell").unwrap().in_equilibrium(), "bsdf", (192, 144), 120);
    assert!(outcome.counts.rays >= 20_000_000, "only {} rays", outcome.counts.rays);
    assert_eq!((outcome.counts.escaped, outcome.counts.truncated, outcome.counts.invalid), (0, 0, 0));
}

/// S42 where it happens: a ray that leaves the ceiling 1e-1 to 1e-8 from the left wall, towards it. An epsilon of 1e-4 skips the wall, and
/// the path goes on behind it, mostly without ever counting as escaped, because the other walls' spheres go on there too.
#[test]
fn edges_have_no_gap() {
    let scene = load("cornell").unwrap();
    for k in 0..100_000 {
        let [u, v] = uniform(k);
        let gap = libm::exp10(-1.0 - 7.0 * u);
        let z = 10.0 + 140.0 * v;
        // Where the spheres of left wall and ceiling meet: each bulges by (square of the distance from its middle) / 2r.
        let sag = |a: f64, b: f64| (a * a + b * b) / (1e5 + (1e10 - a * a - b * b).sqrt());
        let mut edge = 1.0;
        for _ in 0..4 {
            let height = 81.6 - sag(edge + gap - 50.0, z - 81.6);
            edge = 1.0 + sag(height - 40.8, z - 81.6);
        }
        let x = edge + gap;
        let up = Ray { origin: Vec3::new(x, 40.0, z), direction: Vec3::new(0.0, 1.0, 0.0) };
        let ceiling = intersect(&scene, &up, None).expect("a ceiling");
        assert_eq!(scene.objects[ceiling.object as usize].name, "ceiling");
        let ray = Ray { origin: ceiling.point, direction: Vec3::new(-1.0, -0.3, 0.1).normalized() };
        let hit =
            intersect(&scene, &ray, Some(Standpoint { primitive: ceiling.primitive, inside: true })).expect("a wall");
        // The wall slopes by up to 1e-3 and its sphere's numbers are rounded at 1e-11.
        let expected = gap / -ray.direction.x;
        let name = scene.objects[hit.object as usize].name.as_str();
        assert!(
            name == "left wall" && (hit.t - expected).abs() <= 1e-10 + 2e-3 * expected,
            "gap {gap:e}: {name} at {}",
            hit.t
        );
    }
}

/// S48: the nearer of two shells 2^-40 apart wins from either side, and of two identical spheres the first in the scene.
#[test]
fn ties_go_to_the_first_object() {
    let outer = 1.0 + libm::exp2(-40.0);
    let thin = load_scene([0.0; 3], &[ball([0.0; 3], 1.0, DIFFUSE), ball([0.0; 3], outer, DIFFUSE)]).unwrap();
    let identical = [0.5, 1.0, 1.0, 1.0].map(|radius| ball([0.0; 3], radius, DIFFUSE));
    let identical = load_scene([0.0; 3], &identical).unwrap();
    for k in 0..1000 {
        let [u, v] = uniform(k);
        let out = Vec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.1).normalized();
        let inwards = Ray { origin: out * 3.0, direction: -out };
        let outwards = Ray { origin: out * 0.9, direction: out };
        let seen = |scene: &Scene, ray: &Ray| intersect(scene, ray, None).map(|hit| hit.object);
        assert_eq!((seen(&thin, &inwards), seen(&thin, &outwards)), (Some(1), Some(0)), "thin shell, {out:?}");
        assert_eq!(seen(&identical, &outwards), Some(1), "identical spheres from inside, {out:?}");
        assert_eq!(seen(&identical, &inwards), Some(1), "identical spheres from outside, {out:?}");
    }
}

/// S60: where the light's sphere reaches through the ceiling's is a circle of radius 17.944246733607267781; the surfaces cross at 1.7
/// degrees, so an error e in a distance would move the edge by 33 e.
#[test]
fn the_light_cap_ends_where_geometry_says() {
    const RADIUS: f64 = 17.944_246_733_607_27;
    let scene = load("cornell").unwrap();
    let (mut light, mut ceiling) = (0, 0);
    for k in 0..100_000 {
        let [u, v] = uniform(k);
        let rho = match k % 3 {
            0 => 30.0 * v.sqrt(),
            1 => RADIUS + libm::exp10(-8.0 + 8.0 * v),
            _ => RADIUS - libm::exp10(-8.0 + 8.0 * v),
        };
        let turn = std::f64::consts::TAU * u;
        let (x, z) = (50.0 + rho * libm::cos(turn), 81.6 + rho * libm::sin(turn));
        let rho = libm::hypot(x - 50.0, z - 81.6);
        let ray = Ray { origin: Vec3::new(x, 40.0, z), direction: Vec3::new(0.0, 1.0, 0.0) };
        let hit = intersect(&scene, &ray, None).expect("a ceiling");
        let expected = if rho < RADIUS { "light" } else { "ceiling" };
        let found = scene.objects[hit.object as usize].name.as_str();
        assert!(found == expected || (rho - RADIUS).abs() < 1e-8, "{found} at radius {rho}");
        *(if found == "light" { &mut light } else { &mut ceiling }) += 1;
    }
    assert!(light > 30_000 && ceiling > 30_000, "{light} {ceiling}");
}

/// S62: every camera ray starts in front of the front wall (z = 170) and inside every wall, with a direction of length 1, at the extremes
/// of the pixel filter too.
#[test]
fn camera_rays_start_inside_the_box() {
    let scene = load("cornell").unwrap();
    let almost_one = 1.0 - f64::EPSILON / 2.0;
    for (width, height) in [(1024, 768), (1, 1), (7, 300)] {
        let view = scene.camera.view(width, height);
        for y in 0..height {
            for x in 0..width {
                for (sample, u) in [(0, [0.0, 0.0]), (1, [almost_one, 0.0]), (2, [0.0, almost_one]), (3, [0.5, 0.5])] {
                    let Ray { origin, direction } = view.ray::<AllEffects>(x, y, sample, u, || [0.0; 2]);
                    assert!((dot(direction, direction).sqrt() - 1.0).abs() <= 4.0 * f64::EPSILON);
                    if width > 7 {
                        let inside = (1.0..99.0).contains(&origin.x) && (0.0..81.6).contains(&origin.y);
                        assert!(inside && origin.z < 169.0, "pixel {x},{y}: {origin:?}");
                    }
                }
            }
        }
    }
}

/// S64: 1e4 mirror bounces inside a sphere of radius 1e5 without renormalising keep |d| = 1 within 1e-12. With renormalising, as paths do
/// it, every chord of that walk has the length of the first (closed form: 2 r cos).
#[test]
fn mirror_chains_do_not_drift() {
    let scene = load_scene([0.0; 3], &[ball([50.0, 40.8, 81.6], 1e5, MIRROR)]).unwrap();
    for renormalise in [false, true] {
        let direction = Vec3::new(0.3, -0.2, 0.93).normalized();
        let mut ray = Ray { origin: Vec3::new(70_000.0, 30_000.0, -10_000.0), direction };
        let (mut from, mut chord) = (None, None);
        for bounce in 0..10_000 {
            let hit = intersect(&scene, &ray, from).expect("a closed sphere");
            if renormalise && bounce > 0 {
                let first = *chord.get_or_insert(hit.t);
                assert!((hit.t / first - 1.0).abs() < 1e-11, "bounce {bounce}: chord {} after {first}", hit.t);
            }
            let (next, standpoint) = scatter(&scene, &hit, ray.direction, 0.0);
            let length = dot(next.direction, next.direction).sqrt();
            assert!((length - 1.0).abs() <= 1e-12, "bounce {bounce}: |d| - 1 = {:e}", length - 1.0);
            ray = if renormalise { Ray { direction: next.direction.normalized(), ..next } } else { next };
            from = Some(standpoint);
        }
    }
}
