//! Ray against sphere, compared with exact answers: S01-S31 of the catalogue of hard cases.
//!
//! Two oracles: `data/sphere-oracle.json` (mpmath, 40 to 60 digits), and for bulk a quadratic in double-double numbers, which takes its
//! discriminant from the cross product, |d|² r² - |f x d|², and so shares no formula with the code that it judges.

#[path = "support/double_double.rs"]
mod double_double;
#[path = "support/random.rs"]
mod random;
#[path = "support/scene_text.rs"]
mod scene_text;

use double_double::two_product;
use pathmark::math::{Ray, Vec3, dot, first_root, roots};
use pathmark::scene::{Primitive, Sphere};
use rand_pcg::Pcg64Mcg;
use random::Random;
use scene_text::{Ball, load_scene};

const U: f64 = f64::EPSILON / 2.0;

/// The exact line and sphere: distance of the line from the centre, and the roots if there are any.
struct Exact {
    line: f64,
    roots: Option<[f64; 2]>,
}

fn exact(f: Vec3, d: Vec3, r: f64) -> Exact {
    let product = |p: Vec3, q: Vec3| two_product(p.x, q.x) + two_product(p.y, q.y) + two_product(p.z, q.z);
    let cross = |a: f64, b: f64, c: f64, e: f64| two_product(a, b) - two_product(c, e);
    let (x, y, z) = (cross(f.y, d.z, f.z, d.y), cross(f.z, d.x, f.x, d.z), cross(f.x, d.y, f.y, d.x));
    let (a, b, moment) = (product(d, d), -product(f, d), x * x + y * y + z * z);
    let discriminant = a * two_product(r, r) - moment;
    let line = (moment.0 / a.0).sqrt();
    if discriminant.0 < 0.0 {
        return Exact { line, roots: None };
    }
    let root = discriminant.sqrt();
    let q = if b.0 > 0.0 { b + root } else { b - root };
    let (by_q, by_c) = (q.over(a), (product(f, f) - two_product(r, r)).over(q));
    Exact { line, roots: Some(if by_q < by_c { [by_q, by_c] } else { [by_c, by_q] }) }
}

/// The bound `T_s` on the error of root `t`, in lengths of `d`; infinite at tangency, where the roots' slope is.
fn bound(f: Vec3, d: Vec3, r: f64, line: f64, t: f64) -> f64 {
    let (length, distance) = (dot(d, d).sqrt(), dot(f, f).sqrt());
    let s = ((r - line) * (r + line)).max(0.0).sqrt();
    let b = dot(f, d).abs() / length;
    let terms = distance + (r * r + 2.0 * line * distance) / (2.0 * s) + (distance * distance + r * r) / (b + s);
    let error = 8.0 * U * (t.abs() + terms / length);
    if error.is_nan() { f64::INFINITY } else { error }
}

fn first(f: Vec3, d: Vec3, a: f64, r: f64) -> Option<f64> {
    Some(first_root(f, d, a, r)).filter(|t| *t > 0.0)
}

/// Whether `found` is the first root ahead. A root within the bound of zero may be seen as ahead or as behind.
fn is_first(found: Option<f64>, exact: [f64; 2], bounds: [f64; 2]) -> bool {
    let near = |k: usize, t: f64| (t - exact[k]).abs() <= bounds[k];
    let behind = |k: usize| exact[k] <= bounds[k];
    match found {
        None => behind(0) && behind(1),
        Some(t) => near(0, t) || (behind(0) && near(1, t)),
    }
}

struct OracleRay {
    name: String,
    f: Vec3,
    d: Vec3,
    r: f64,
    roots: Option<[f64; 2]>,
}

fn oracle() -> Vec<OracleRay> {
    let rows: serde_json::Value = serde_json::from_str(include_str!("data/sphere-oracle.json")).unwrap();
    let vector = |v: &serde_json::Value| Vec3::from(std::array::from_fn(|k| v[k].as_f64().unwrap()));
    let root = |v: &serde_json::Value| v.as_str().map(|text| text.parse::<f64>().unwrap());
    let row = |v: &serde_json::Value| OracleRay {
        name: v["name"].as_str().unwrap().to_string(),
        f: vector(&v["o"]) - vector(&v["c"]),
        d: vector(&v["d"]),
        r: v["r"].as_f64().unwrap(),
        roots: root(&v["t0"]).zip(root(&v["t1"])).map(|(near, far)| [near, far]),
    };
    rows.as_array().unwrap().iter().map(row).collect()
}

/// Rays whose squared length leaves the range of f64: the contract is 1e-100 < |d| < 1e100, and outside it a miss, never a wrong hit.
const OUTSIDE_DIRECTION: [&str; 3] = ["non-unit d 1e-200", "huge d 1e200", "zero dir"];
/// Spheres that the scene reader refuses.
const OUTSIDE_SPHERE: [&str; 5] = ["r=0 through centre", "r=-1", "r subnormal 5e-324", "r=1e200", "r=1e160 coords"];

#[test]
fn all_rays_of_the_mpmath_oracle() {
    let rays = oracle();
    assert_eq!(rays.len(), 30);
    let mut compared = 0;
    for OracleRay { name, f, d, r, roots: expected } in rays {
        let a = dot(d, d);
        let (near, far) = roots(f, d, a, r);
        if OUTSIDE_DIRECTION.contains(&name.as_str()) {
            assert_eq!(first(f, d, a, r), None, "{name}");
        } else if OUTSIDE_SPHERE.contains(&name.as_str()) {
            let material = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }".to_string();
            let ball = Ball { center: [-f.x, -f.y, -f.z], radius: r, material, emission: [0.0; 3] };
            assert!(load_scene([0.0; 3], &[ball]).is_err(), "{name} was accepted");
        } else if let Some(expected) = expected {
            let line = exact(f, d, r).line;
            let bounds = expected.map(|t| bound(f, d, r, line, t));
            let errors = [(near - expected[0]).abs(), (far - expected[1]).abs()];
            // "on surface tangent" is a double root at 0: 0/0, no hit, and no number to compare.
            if name != "on surface tangent" {
                assert!(errors[0] <= bounds[0] && errors[1] <= bounds[1], "{name}: {near} {far}, exact {expected:?}");
            }
            let found = first(f, d, a, r);
            assert!(is_first(found, expected, bounds), "{name}: first {found:?}, exact {expected:?}");
        } else {
            assert!(near.is_nan() && far.is_nan() && first(f, d, a, r).is_none(), "{name}: {near} {far}");
        }
        compared += 1;
    }
    assert_eq!(compared, 30);
}

/// S11-S23 and S31, the ones that are exact: what must come out to the bit, and what must not come out at all.
#[test]
fn tangents_surfaces_and_degenerate_rays() {
    let at = |x: f64, y: f64, d: [f64; 3]| {
        let d = Vec3::from(d);
        first(Vec3::new(x, y, 0.0), d, dot(d, d), 1.0)
    };
    let forward = [1.0, 0.0, 0.0];
    assert_eq!(at(-2.0, 1.0, forward), Some(2.0), "S11: the sphere is closed, a tangent hits");
    assert_eq!(at(-2.0, 1.0 + 2.0 * U, forward), None, "S12");
    assert_eq!(at(-2.0, 1.0 - U, forward), Some(1.999_999_985_098_838_8), "S13: the roots do not merge");
    assert_eq!(at(1.0, 0.0, forward), None, "S14: from the surface outwards");
    assert_eq!(at(1.0, 0.0, [-1.0, 0.0, 0.0]), Some(2.0), "S15: from the surface inwards");
    assert_eq!(at(1.0, 0.0, [0.0, 1.0, 0.0]), None, "S16: tangent on the surface");
    assert_eq!(at(2.0, 0.0, forward), None, "S18: behind");
    assert_eq!(at(0.5, 0.0, forward), Some(0.5), "S31: from inside, the far root");
    for d in [[0.6, 0.8, 0.0], [0.0, 0.0, -1.0], [-0.0, 1.0, 0.0]] {
        let t = at(0.0, 0.0, d).expect("S17: from the centre");
        assert!((t - 1.0).abs() <= 4.0 * U, "S17: {t}");
    }
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    assert_eq!(at(-5.0, 0.25, [0.0; 3]), None, "S23: zero direction");
    for x in bad {
        assert_eq!(at(-5.0, 0.25, [x, 0.0, 0.0]), None, "S23: direction {x}");
        assert_eq!(at(x, 0.0, forward), None, "S23: origin {x}");
    }
    // S28: report A's sentinel of 1e20 would lose this one.
    let far = first(Vec3::new(-1e21, 0.0, 0.0), Vec3::from(forward), 1.0, 1.0).expect("S28");
    assert!((far - 1e21).abs() <= 8.0 * U * 1e21);
}

/// Origin, unit direction and radius, aimed so that hits, misses and near tangents of every degree all occur.
fn aimed(random: &mut Random) -> (Vec3, Vec3, f64) {
    let r = random.scale(-6.0, 8.0);
    let distance = match random.below(8) {
        0..=3 => r * random.scale(-3.0, 8.0),
        4..=6 => r * (1.0 - random.scale(-12.0, -1.0)),
        _ => r * (1.0 + random.below(9) as f64 * 2.0 * U - 8.0 * U),
    };
    let f = random.direction() * distance;
    let aim = match random.below(4) {
        0 => random.unit(),
        1 => 1.2 * random.unit(),
        2 => 1.0 - random.scale(-16.0, -1.0),
        _ => 1.0 + random.scale(-16.0, -1.0),
    };
    let target = f.cross(random.direction()).normalized() * (aim * r);
    let towards = (target - f).normalized();
    (f, if random.below(8) == 0 { -towards } else { towards }, r)
}

/// S29 with S19: a million rays, radius 1e-6 to 1e8, 1e-3 to 1e8 radii away or from 1e-12 to 0.1 radii below the surface, and its
/// 1-ulp neighbours; directions of length 1 as the scene uses them, and of length 1e-3 to 1e3.
#[test]
fn a_million_rays_stay_within_the_bound() {
    let mut random = Random(Pcg64Mcg::new(0x5EED));
    let (mut hits, mut misses, mut excused) = (0u32, 0u32, 0u32);
    for k in 0..1_000_000 {
        let (f, unit, r) = aimed(&mut random);
        let stretched = k % 2 == 1;
        let d = if stretched { unit * random.scale(-3.0, 3.0) } else { unit };
        let a = if stretched { dot(d, d) } else { 1.0 };
        let Exact { line, roots: expected } = exact(f, d, r);
        let (near, far) = roots(f, d, a, r);
        let found = first(f, d, a, r);
        if !stretched {
            // What the scene calls is the same formula.
            let meet =
                Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: r }.meet(&Ray { origin: f, direction: d }, &());
            assert_eq!(Some(meet).filter(|t| *t > 0.0), found);
        }
        match expected {
            Some(expected) if !near.is_nan() => {
                let bounds = expected.map(|t| bound(f, d, r, line, t));
                let errors = [(near - expected[0]).abs(), (far - expected[1]).abs()];
                assert!(
                    errors[0] <= bounds[0] && errors[1] <= bounds[1] && is_first(found, expected, bounds),
                    "f {f:?} d {d:?} r {r:e}: {near:e} {far:e} first {found:?}, exact {expected:?} within {bounds:?}"
                );
                hits += 1;
            }
            None if near.is_nan() => {
                assert_eq!(found, None);
                misses += 1;
            }
            _ => {
                let band = 8.0 * U * (dot(f, f).sqrt() + r);
                assert!((r - line).abs() <= band, "f {f:?} d {d:?} r {r:e}: hit and miss differ {:e} away", r - line);
                excused += 1;
            }
        }
    }
    // The generator must keep both kinds common, and the excuse rare enough to mean something.
    assert!(hits > 500_000 && misses > 50_000 && excused < 10_000, "{hits} {misses} {excused}");
}

/// S30: 2^20 parallel rays one ulp apart across the silhouette; from the first miss on there is no hit. Parallel to an axis the answer is
/// exact at every one of them, tilted at every one outside the band.
#[test]
fn the_silhouette_is_monotone() {
    let miss = |f: Vec3, d: Vec3| roots(f, d, 1.0, 1.0).0.is_nan();
    let axis = Vec3::new(1.0, 0.0, 0.0);
    let half = 1i64 << 19;
    for k in -half..half {
        let y = f64::from_bits((1.0f64.to_bits() as i64 + k) as u64);
        assert_eq!(miss(Vec3::new(-2.0, y, 0.0), axis), k > 0, "{k} ulp from the silhouette");
    }
    let tilted = Vec3::new(0.36, 0.48, 0.8).normalized();
    let across = Vec3::new(0.8, -0.6, 0.0);
    for step in 0..20 {
        for side in [-1.0, 1.0] {
            let y = 1.0 + side * 64.0 * U * f64::from(1 << step);
            assert_eq!(miss(across * y - tilted * 3.0, tilted), side > 0.0, "step {step} side {side}");
        }
    }
}
