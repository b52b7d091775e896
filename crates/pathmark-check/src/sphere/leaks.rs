//! Closed scenes that lose no ray, and lights that do not block themselves.

use super::formulas::{SMALLPT_EPSILON, smallpt_first_root};
use crate::Trials;
use crate::bare_scene::{intersect, searches};
use crate::estimator::ESTIMATORS;
use crate::kernel::Spec;
use crate::math::{Ray, Vec3};
use crate::random::Random;
use crate::rendering::{by_kernel, try_render};
use crate::scene::{Scene, SurfaceOrigin, load};
use crate::stage::{DIFFUSE, camera, named, try_scene};
use std::sync::Arc;

pub(super) fn closed_box(trials: &mut Trials) {
    let most = trials.times(100_000, 100_000_000);
    let cornell = load("cornell").expect("a shipped scene");
    let equilibrium = Arc::new(cornell.in_equilibrium());
    for (scene, what) in [(Arc::new(cornell), "lit"), (equilibrium, "in equilibrium")] {
        for estimator in ESTIMATORS {
            let spec = Spec { width: 96, height: 72, estimator: estimator.name.into(), ..Spec::default() };
            for spec in by_kernel(&spec) {
                rays_that_escape(trials, &scene, what, &spec, most);
            }
        }
    }
    edges(trials);
}

/// Renders with successive seeds until so many rays have been traced.
fn rays_that_escape(trials: &mut Trials, scene: &Arc<Scene>, what: &str, spec: &Spec, most: u64) {
    let (mut rays, mut lost, mut seed) = (0, 0, 0);
    while rays < most {
        seed += 1;
        let spp = if most > 10_000_000 { 256 } else { 4 };
        let Some(outcome) = try_render(trials, scene, Spec { seed, ..spec.clone() }, spp) else { return };
        rays += outcome.counts.rays;
        lost += outcome.counts.escaped + outcome.counts.invalid;
    }
    let variant = format!("{what}, {}, {}", spec.estimator, spec.kernel);
    trials.never(variant, "rays that met nothing or samples that are no radiance", lost, rays);
}

/// Rays that leave the ceiling towards the left wall, 1e-1 to 1e-8 away from it. An epsilon of 1e-4 skips the wall,
/// and the path continues behind it. It mostly never counts as escaped, because the spheres of the other walls
/// continue there, too.
fn edges(trials: &mut Trials) {
    let rays = trials.times(20_000, 2_000_000);
    let cornell = load("cornell").expect("a shipped scene");
    for (accelerator, scene) in searches(&cornell) {
        let name = |primitive: u32| scene.objects[scene.owners[primitive as usize] as usize].name.as_str();
        let mut random = Random::new(42);
        let (mut wrong, mut skipped) = (0, 0);
        for _ in 0..rays {
            let (gap, z) = (random.scale(-8.0, -1.0), 10.0 + 140.0 * random.unit());
            // The edge where the spheres of left wall and ceiling meet: each bulges by (square of the distance from
            // its middle) / 2r.
            let sag = |a: f64, b: f64| (a * a + b * b) / (1e5 + (1e10 - a * a - b * b).sqrt());
            let mut edge = 1.0;
            for _ in 0..4 {
                let height = 81.6 - sag(edge + gap - 50.0, z - 81.6);
                edge = 1.0 + sag(height - 40.8, z - 81.6);
            }
            let up = Ray { origin: Vec3::new(edge + gap, 40.0, z), direction: Vec3::new(0.0, 1.0, 0.0) };
            let Some(ceiling) = intersect(&scene, &up, None).filter(|hit| name(hit.primitive) == "ceiling") else {
                wrong += 1;
                continue;
            };
            let ray = Ray { origin: ceiling.point, direction: Vec3::new(-1.0, -0.3, 0.1).normalized() };
            let from = SurfaceOrigin { primitive: ceiling.primitive, inside: true };
            // The wall's slope is up to 1e-3, and the coordinates of its sphere are rounded at 1e-11.
            let expected = gap / -ray.direction.x;
            let wall = intersect(&scene, &ray, Some(from)).filter(|hit| name(hit.primitive) == "left wall");
            wrong += u64::from(!wall.is_some_and(|hit| (hit.t - expected).abs() <= 1e-10 + 2e-3 * expected));
            let f = ray.origin - Vec3::new(100_001.0, 40.8, 81.6);
            skipped += u64::from(smallpt_first_root(f, ray.direction, 1e5, SMALLPT_EPSILON) == 0.0);
        }
        trials.never(format!("edges, accelerator {accelerator}"), "rays that do not meet the wall there", wrong, rays);
        let told = format_args!("{skipped} of {rays}");
        trials.holds("smallpt's epsilon", "skips the wall, or these rays would prove nothing", told, skipped > 0);
    }
}

/// A ray that is aimed at a light must hit it, whatever the size of the light, and nothing nearer may block it.
pub(super) fn lights(trials: &mut Trials) {
    let rays = trials.times(20_000, 2_000_000);
    for (radius, height, across) in [(600.0, 681.33, 100.0), (0.005, 0.0051, 0.1), (0.005, 50.0, 100.0)] {
        let light = format!("{{ sphere = {{ center = [0.0, {height:?}, 0.0], radius = {radius:?} }} }}");
        let floor = "{ plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] } }";
        let parts = [
            camera([0.0, 0.5, 9.0], [0.0, 0.0, 9.0]),
            named("light", &light, DIFFUSE, 1.0),
            named("floor", floor, DIFFUSE, 0.0),
        ];
        let scene = try_scene(&parts).expect("a right scene");
        let lit = scene.lit(&scene.camera.view(4, 4));
        for (name, scene) in searches(&lit) {
            let Some(lights) = &scene.lights else { continue };
            let mut random = Random::new(45);
            let (mut missed, mut blocked, mut tried) = (0, 0, 0);
            for _ in 0..rays {
                let mut place = || (2.0 * random.unit() - 1.0) * across;
                let point = Vec3::new(place(), 0.0, place());
                // Excludes the very rim of the cone, where a tangent may miss.
                let u = [random.unit(), (1.0 - 1e-9) * random.unit()];
                let from = Some(SurfaceOrigin { primitive: 1, inside: false });
                let Some(aim) = lights.aim(point, from, || 0.0, u) else { continue };
                let ray = Ray { origin: point, direction: aim.direction };
                tried += 1;
                let Some(hit) = intersect(&scene, &ray, from).filter(|hit| hit.primitive == aim.primitive) else {
                    missed += 1;
                    continue;
                };
                let is_blocked = |limit: f64| scene.is_blocked_by_any(&ray, from, limit);
                // The way is free up to the light; just beyond, the light blocks it.
                blocked += u64::from(is_blocked(hit.t) || !is_blocked(hit.t.next_up()));
            }
            let variant = format!("radius {radius}, {height} above the floor, accelerator {name}");
            trials.never(&variant, "aims that do not arrive", missed, tried);
            trials.never(&variant, "lights that block their own way", blocked, tried);
        }
    }
}
