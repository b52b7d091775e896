//! Triangles so thin, or so far away for their size, that rounding decides whether and where a ray hits them: every
//! search agrees.

use super::hierarchies::in_cube;
use super::single::towards;
use crate::Trials;
use crate::bare_scene::{intersect, scene_of, searches};
use crate::kernel::{KERNELS, Spec};
use crate::math::{Ray, Vec3, dot};
use crate::random::Random;
use crate::rendering;
use crate::scene::{ACCELERATORS, Hit, Primitives, Scene, Sphere, SurfaceOrigin, Triangle};
use crate::simd::Precision;
use crate::stage::{self, diffuse, object, quad, view};

/// A triangle with an area and a relative height of about 10^`height`, at most 5 from the origin.
fn sliver(random: &mut Random, height: f64) -> Triangle {
    loop {
        let (a, along) = (in_cube(random) * 2.5, random.direction() * random.scale(-1.0, 0.4));
        let third = match random.below(3) {
            0 => 0.0,
            1 => 1.0,
            _ => random.unit(),
        };
        let length = dot(along, along).sqrt();
        let c = a + along * third + random.direction() * (length * libm::exp10(height));
        let triangle = Triangle { corners: [a, a + along, c] };
        if !triangle.is_degenerate() {
            return triangle;
        }
    }
}

/// Slivers, with other primitives before and behind them.
fn among_others(random: &mut Random, height: f64) -> Primitives {
    let sliver = |_| sliver(random, height);
    let mut triangles: Vec<Triangle> = (0..24).map(sliver).collect();
    triangles.extend((0..6).map(|_| {
        let a = in_cube(random) * 2.0;
        Triangle { corners: [a, a + random.direction(), a + random.direction()] }
    }));
    // Spheres at the ends of slivers: a distance that is off by the sliver's length would come before a nearer hit.
    let ends = triangles[..24].iter().flat_map(|triangle| triangle.corners);
    let spheres = ends.map(|center| Sphere { center, radius: random.scale(-4.0, -2.0) }).collect();
    Primitives { spheres, triangles, ..Primitives::default() }
}

/// Triangles of size 1, so far away that they measure a few units in the last place.
fn far_away(random: &mut Random, away: f64) -> Primitives {
    let middle = random.direction() * away;
    let near = |random: &mut Random| middle + in_cube(random);
    let mut triangles = Vec::new();
    while triangles.len() < 24 {
        let triangle = Triangle { corners: [near(random), near(random), near(random)] };
        if !triangle.is_degenerate() {
            triangles.push(triangle);
        }
    }
    Primitives { triangles, ..Primitives::default() }
}

pub(super) fn same_hits(trials: &mut Trials) {
    let scenes = trials.times(16, 4000);
    for height in [-12.0, -14.0, -15.0, -16.0, -17.0] {
        compare(trials, &format!("heights of 1e{height}"), scenes, |random| among_others(random, height));
    }
    for away in [1e12, 1e14, 1e15] {
        compare(trials, &format!("{away:e} away"), scenes, |random| far_away(random, away));
    }
}

/// Compares all searches for rays at points of triangles, and for rays that continue from the hits, in scenes of these
/// primitives.
fn compare(trials: &mut Trials, what: &str, scenes: u64, mut primitives: impl FnMut(&mut Random) -> Primitives) {
    let mut random = Random::new(22);
    let [mut hits, mut rays] = [0, 0];
    let (mut differ, mut blocked_otherwise) = (vec![0; ACCELERATORS.len()], vec![0; ACCELERATORS.len()]);
    for _ in 0..scenes {
        let all = scene_of(primitives(&mut random));
        let searches: Vec<(&str, Scene)> = searches(&all).collect();
        for _ in 0..200 {
            let mut origin = random.direction() * random.scale(-1.0, 2.0);
            let mut from = None;
            for _ in 0..3 {
                let ray = at_a_point(&mut random, &all.primitives.triangles, origin);
                let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.primitive, hit.inside));
                let expected = intersect(&all, &ray, from);
                rays += 1;
                let Some(hit) = expected else { break };
                hits += 1;
                let counts = differ.iter_mut().zip(&mut blocked_otherwise);
                for ((differ, blocked_otherwise), (_, scene)) in counts.zip(&searches) {
                    *differ += u64::from(bits(intersect(scene, &ray, from)) != bits(expected));
                    let is_blocked = |limit| scene.is_blocked_by_any(&ray, from, limit);
                    *blocked_otherwise += u64::from(is_blocked(hit.t) || !is_blocked(hit.t.next_up()));
                }
                from = Some(SurfaceOrigin { primitive: hit.primitive, inside: false });
                origin = hit.point;
            }
        }
    }
    for ((entry, differ), blocked_otherwise) in ACCELERATORS.iter().zip(differ).zip(blocked_otherwise) {
        let variant = format!("{what}, accelerator {}", entry.name);
        trials.never(&variant, "other hits", differ, hits);
        trials.never(&variant, "other answers to what is in the way", blocked_otherwise, hits);
    }
    let told = format_args!("{hits} of {rays}");
    trials.holds(what, "a hundredth of the rays hit, or they prove nothing", told, hits * 100 > rays);
}

fn at_a_point(random: &mut Random, triangles: &[Triangle], origin: Vec3) -> Ray {
    let [a, b, c] = triangles[random.below(triangles.len())].corners;
    let (u, v) = (random.unit(), random.unit());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    towards(origin, a + (b - a) * u + (c - a) * v)
}

pub(super) fn same_images(trials: &mut Trials) {
    let scenes = trials.times(24, 2000);
    let anything = quad([[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let mut random = Random::new(23);
    let mut differ = [0; 2];
    for _ in 0..scenes {
        let mut scene = stage::scene(&[
            "background = [0.1, 0.2, 0.3]\n".to_string(),
            view([0.0, 0.0, 6.0], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 70.0),
            object(&anything, &diffuse(0.75), [0.0; 3]),
            object(&anything, &diffuse(0.5), [1.0; 3]),
        ]);
        let height = -13.0 - 4.0 * random.unit();
        scene.primitives = among_others(&mut random, height);
        scene.owners = (0..scene.primitives.counts().iter().sum::<usize>() as u32).map(|k| k % 2).collect();
        let spec = Spec { width: 12, height: 12, seed: 22, estimator: "nee".into(), ..Spec::default() };
        for precision in Precision::ALL {
            let mut checksums = Vec::new();
            for accelerator in ACCELERATORS {
                // Only the lanes kernel has single precision.
                for kernel in KERNELS.iter().take(if precision == Precision::F64 { KERNELS.len() } else { 1 }) {
                    let (accelerator, kernel) = (Some(accelerator.name.to_string()), kernel.name.to_string());
                    let precision = precision.name().to_string();
                    let spec = Spec { kernel, precision, accelerator, ..spec.clone() };
                    checksums.push(rendering::run(&scene, spec, 64).checksum);
                }
            }
            checksums.dedup();
            differ[precision as usize] += u64::from(checksums.len() > 1);
        }
    }
    for precision in Precision::ALL {
        trials.never(precision.name(), "scenes with several images", differ[precision as usize], scenes);
    }
}
