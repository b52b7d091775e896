//! Values and arrangements of primitives that mislead builders of hierarchies.

use super::hierarchies::{any_ray, in_cube};
use crate::Trials;
use crate::bare_scene::{intersect, scene_of, scene_of_spheres, searches};
use crate::math::{Ray, Vec3};
use crate::random::Random;
use crate::refusals::refuses_shape;
use crate::run::on_threads;
use crate::scene::{Hit, Plane, Primitives, Scene, Sphere};

/// Levels that fit on the traversal's stack: 32 by the rule, then halvings of up to 2^32 primitives.
const DEEPEST: usize = 64;

fn same_spheres(count: usize, center: impl Fn(usize) -> [f64; 3], radius: impl Fn(usize) -> f64) -> Scene {
    scene_of_spheres((0..count).map(|k| Sphere { center: Vec3::from(center(k)), radius: radius(k) }).collect())
}

/// No arrangement makes the tree deeper than the stack, and a ray at the last primitive has the same hit with every
/// hierarchy.
pub(super) fn hard_to_build(trials: &mut Trials) {
    let line = |k: usize| [k as f64, 0.0, 0.0];
    let shrinking = |k: usize| libm::exp2(-(k as f64) / 8.0);
    let many = trials.times(100_000, 1_000_000) as usize;
    let cases: [(&str, Scene); 10] = [
        ("one", same_spheres(1, line, |_| 0.4)),
        ("two", same_spheres(2, line, |_| 0.4)),
        ("65537 identical", same_spheres(65_537, |_| [1.0; 3], |_| 0.4)),
        ("ten, each very often", same_spheres(many, |k| line(k % 10), |_| 0.4)),
        ("concentric", same_spheres(1000, |_| [0.0; 3], |k| 1.0 + k as f64)),
        ("on a line", same_spheres(65_537, line, |_| 0.4)),
        (
            "on a line, each twice as far",
            same_spheres(300, |k| [libm::exp2(k as f64), 0.0, 0.0], |k| 0.4 * libm::exp2(k as f64)),
        ),
        // A surface area heuristic that splits off one primitive at a time would give one level per primitive.
        ("a tower that shrinks", same_spheres(2000, |k| [shrinking(k), 0.0, 0.0], |k| shrinking(k) * libm::exp2(-5.0))),
        ("one huge among tiny", same_spheres(1000, line, |k| if k == 500 { 1e30 } else { 1e-3 })),
        ("powers of ten", same_spheres(180, |k| [libm::exp10(k as f64 - 90.0); 3], |_| 1e-95)),
    ];
    let bits = |hit: Option<Hit>| hit.map(|hit| (hit.t.to_bits(), hit.primitive));
    for (what, plain) in cases {
        let target = plain.primitives.spheres[plain.primitives.spheres.len() - 1];
        let origin = target.center + Vec3::new(0.0, 0.0, 2.0 * target.radius);
        let ray = Ray { origin, direction: Vec3::new(0.0, 0.0, -1.0) };
        let expected = bits(intersect(&plain, &ray, None));
        trials.holds(what, "the ray hits", format_args!("{expected:?}"), expected.is_some());
        for (name, scene) in searches(&plain) {
            let Some(hierarchy) = &scene.hierarchy else { continue };
            let depth = hierarchy.depth();
            let variant = format!("{what}, accelerator {name}");
            trials.holds(&variant, format_args!("at most {DEEPEST} levels"), depth, depth <= DEEPEST);
            trials.same(&variant, &expected, &bits(intersect(&scene, &ray, None)));
        }
    }
    nothing_to_build(trials);
    not_a_number(trials);
}

/// Without bounded primitives there is nothing to build, and the plane is still found.
fn nothing_to_build(trials: &mut Trials) {
    let plane = Plane { point: Vec3::new(0.0, 0.0, 0.0), normal: Vec3::new(0.0, 1.0, 0.0) };
    let ray = Ray { origin: Vec3::new(0.0, 2.0, 0.0), direction: Vec3::new(0.0, -1.0, 0.0) };
    for (planes, expected) in [(vec![plane], Some(2.0)), (Vec::new(), None)] {
        for (name, scene) in searches(&scene_of(Primitives { planes, ..Primitives::default() })) {
            let found = (scene.hierarchy.is_some(), intersect(&scene, &ray, None).map(|hit| hit.t));
            trials.same(format!("no sphere and no triangle, accelerator {name}"), &(false, expected), &found);
        }
    }
}

/// The reader refuses NaN. A scene that is built with it does not panic, and its other spheres are found.
fn not_a_number(trials: &mut Trials) {
    refuses_shape(trials, "{ sphere = { center = [nan, 0.0, 0.0], radius = 1.0 } }", "center", "nan");
    let places = |k: usize| if k == 50 { [f64::NAN; 3] } else { [k as f64, 0.0, 0.0] };
    for (name, scene) in searches(&same_spheres(100, places, |_| 0.4)) {
        let mut found = 0;
        for k in 0..100 {
            let origin = Vec3::new(f64::from(k), 0.0, 9.0);
            let hit = intersect(&scene, &Ray { origin, direction: Vec3::new(0.0, 0.0, -1.0) }, None);
            found += u32::from(hit.is_some_and(|hit| hit.primitive == k as u32));
        }
        trials.same(format!("99 of 100 spheres beside one that is NaN, accelerator {name}"), &99, &found);
    }
}

pub(super) fn one_tree(trials: &mut Trials) {
    let mut random = Random::new(15);
    let all: Vec<Sphere> =
        (0..2000).map(|_| Sphere { center: in_cube(&mut random), radius: random.scale(-3.0, -1.0) }).collect();
    let mut shuffled = all.clone();
    random.shuffle(&mut shuffled);
    let (all, shuffled) = (scene_of_spheres(all), scene_of_spheres(shuffled));
    let threads = trials.times(8, 64);
    let rays = trials.times(20_000, 1_000_000);
    for ((name, tree), (_, other)) in searches(&all).zip(searches(&shuffled)) {
        let build = || all.accelerated(name).and_then(|scene| scene.hierarchy) == tree.hierarchy;
        match on_threads(threads as usize, build) {
            Ok(same) => {
                let differ = same.into_iter().filter(|same| !same).count();
                trials.never(format!("accelerator {name}"), "other trees", differ as u64, threads);
            }
            Err(refused) => trials.skip(format!("accelerator {name}: {refused}")),
        }
        let differ = (0..rays).filter(|_| {
            let ray = any_ray(&mut random, &all.primitives);
            let (one, two) = (intersect(&tree, &ray, None), intersect(&other, &ray, None));
            one.map(|hit| hit.t) != two.map(|hit| hit.t)
        });
        let differ = differ.count() as u64;
        trials.never(format!("accelerator {name}, shuffled"), "other distances", differ, rays);
    }
}
