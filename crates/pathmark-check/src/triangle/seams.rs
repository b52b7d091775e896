//! Seams between triangles of one surface: a ray that starts within rounding of the seam must not hit the neighbour
//! there.

use super::single::{scene, towards};
use crate::Trials;
use crate::bare_scene::{intersect, searches};
use crate::kernel::{KERNELS, Spec};
use crate::math::{Frame, Ray, Vec3};
use crate::meshes::icosphere;
use crate::random::Random;
use crate::rendering::{self, Moments};
use crate::scene::{ACCELERATORS, Primitive, Primitives, Scene, SurfaceOrigin, Triangle};
use crate::simd::Precision;
use crate::stage::{self, GLASS, camera, diffuse, object, plane, quad};

/// A surface that a ray from its outside hits at most once, and the segments along which its triangles join.
struct Surface {
    name: &'static str,
    triangles: Vec<Triangle>,
    seams: Vec<[Vec3; 2]>,
}

/// Flat surfaces, in a plane that is parallel to no axis and in one that is, and a round surface.
fn surfaces() -> Vec<Surface> {
    let tilted = Frame::around(Vec3::new(0.36, 0.48, 0.8));
    let level = Frame::around(Vec3::new(0.0, 0.0, 1.0));
    let mut all = Vec::new();
    for (frame, names) in [
        (tilted, ["tilted quad", "tilted mesh", "tilted fan", "tilted bricks"]),
        (level, ["quad", "mesh", "fan", "bricks"]),
    ] {
        let at = |x: f64, y: f64| Vec3::new(0.3, -0.7, 1.1) + frame.to_world(Vec3::new(x, y, 0.0));
        // Two triangles per rectangle.
        let rectangle = |[x, y]: [f64; 2], [wide, high]: [f64; 2]| {
            let [a, b, c, d] = [at(x, y), at(x + wide, y), at(x + wide, y + high), at(x, y + high)];
            ([[a, b, c], [a, c, d]].map(|corners| Triangle { corners }), [[a, c], [a, b], [b, c]])
        };
        let tiles = |columns: i32, rows: i32, shift: f64| {
            let size = [2.0 / f64::from(columns), 2.0 / f64::from(rows)];
            let (mut triangles, mut seams) = (Vec::new(), Vec::new());
            for (k, l) in (0..columns).flat_map(|k| (0..rows).map(move |l| (k, l))) {
                let x = (f64::from(k) + shift * f64::from(l % 2)) * size[0] - 1.0;
                let (halves, [diagonal, below, right]) = rectangle([x, f64::from(l) * size[1] - 1.0], size);
                triangles.extend(halves);
                seams.push(diagonal);
                // Leaves out the outer edges.
                seams.extend((l > 0 && (shift == 0.0 || k > 0)).then_some(below));
                seams.extend((k + 1 < columns).then_some(right));
            }
            (triangles, seams)
        };
        let rim: Vec<Vec3> = (0..12)
            .map(|k| libm::sincos(f64::from(k) * std::f64::consts::TAU / 12.0))
            .map(|(sin, cos)| at(cos, sin))
            .collect();
        let middle = at(0.11, 0.07);
        let fan = (0..12).map(|k| Triangle { corners: [middle, rim[k], rim[(k + 1) % 12]] }).collect();
        // Down to points that rounding cannot tell from the middle.
        let spokes =
            rim.iter().flat_map(|tip| [1.0, 1e-7, 1e-16].map(|near| [middle, middle + (*tip - middle) * near]));
        let parts = [tiles(1, 1, 0.0), tiles(7, 5, 0.0), (fan, spokes.collect()), tiles(4, 6, 0.5)];
        all.extend(names.into_iter().zip(parts).map(|(name, (triangles, seams))| Surface { name, triangles, seams }));
    }
    let triangles = icosphere(2);
    let seams = triangles.iter().map(|Triangle { corners: [a, b, _] }| [*a, *b]).collect();
    all.push(Surface { name: "round mesh", triangles, seams });
    all
}

fn point_of(seams: &[[Vec3; 2]], random: &mut Random) -> Vec3 {
    let [a, b] = seams[random.below(seams.len())];
    // In the inner half, away from the other seams at its ends.
    a + (b - a) * (0.25 + 0.5 * random.unit())
}

pub(super) fn rays_from_seams(trials: &mut Trials) {
    let rays = trials.times(10_000, 10_000_000);
    for Surface { name, triangles, seams } in surfaces() {
        let plain = scene(triangles);
        for (accelerator, scene) in searches(&plain) {
            let mut random = Random::new(19);
            let (mut again, mut from_outside, mut own, mut missed) = (0, 0, 0, 0);
            for _ in 0..rays {
                let target = point_of(&seams, &mut random);
                let away = random.direction() * random.scale(0.7, 3.0);
                let Some(hit) = intersect(&scene, &towards(target + away, target), None) else {
                    missed += 1;
                    continue;
                };
                // From steep to so flat that the ray hardly leaves the surface.
                let local = random.direction();
                let flat = random.scale(-6.0, 0.0);
                let outwards = Frame::around(hit.normal).to_world(Vec3::new(local.x, local.y, local.z.abs() * flat));
                for (side, inside) in [(outwards, false), (-outwards, true)] {
                    let from = Some(SurfaceOrigin { primitive: hit.primitive, inside });
                    let ray = Ray { origin: hit.point, direction: side.normalized() };
                    own += u64::from(scene.primitives.triangles[hit.primitive as usize].leave(&ray, inside) > 0.0);
                    let met = intersect(&scene, &ray, from);
                    let is_flat = name != "round mesh";
                    again += u64::from(met.is_some() && (is_flat || !inside));
                    from_outside += u64::from(met.is_some_and(|met| inside && !is_flat && !met.inside));
                }
            }
            let variant = format!("{name}, accelerator {accelerator}");
            // Rays miss at cracks of one rounding in a mesh, or if they run along its rim.
            let told = format_args!("{missed} of {rays}");
            trials.holds(&variant, "a tenth of the rays miss at most", told, missed * 10 < rays);
            trials.never(&variant, "rays that meet the triangle that they leave", own, 2 * rays);
            trials.never(&variant, "rays that meet the surface again", again, 2 * rays);
            trials.never(&variant, "rays that enter it from the inside", from_outside, rays);
        }
    }
}

/// The triangles as one diffuse object under a white sky, seen at a point.
fn under_a_sky(triangles: &[Triangle], target: Vec3, from: Vec3) -> Scene {
    let anything = quad([[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let mut scene = stage::scene(&[
        "background = [1.0, 1.0, 1.0]\n".to_string(),
        camera([from.x, from.y, from.z], [target.x, target.y, target.z]),
        object(&anything, &diffuse(0.75), [0.0; 3]),
    ]);
    scene.primitives = Primitives { triangles: triangles.to_vec(), ..Primitives::default() };
    scene.owners = vec![0; triangles.len()];
    scene
}

/// Specs for both precisions and every accelerator.
fn specs(estimator: &str) -> Vec<Spec> {
    let of = |accelerator: &str, precision: Precision| {
        let (precision, accelerator) = (precision.name().to_string(), Some(accelerator.to_string()));
        Spec { precision, accelerator, ..rendering::spec(estimator, KERNELS[0].name, [16; 2], 19) }
    };
    ACCELERATORS.iter().flat_map(|entry| Precision::ALL.map(|precision| of(entry.name, precision))).collect()
}

fn told(spec: &Spec) -> String {
    format!("{}, {}, {}", spec.estimator, spec.precision, spec.accelerator.as_deref().unwrap_or_default())
}

/// Each path has the camera ray and one ray to the sky.
pub(super) fn two_rays_a_path(trials: &mut Trials) {
    let spp = trials.times(16, 4096) as u32;
    for Surface { name, triangles, seams } in surfaces() {
        let mut random = Random::new(20);
        for _ in 0..trials.times(3, 30) {
            let target = point_of(&seams, &mut random);
            let hit = intersect(&scene(triangles.clone()), &towards(target + random.direction() * 3.0, target), None);
            let Some(hit) = hit else {
                trials.holds(name, "a surface at the seam", "none", false);
                continue;
            };
            let from = target + Frame::around(hit.normal).to_world(Vec3::new(0.5, -0.4, 1.3));
            let scene = under_a_sky(&triangles, target, from);
            for spec in specs("bsdf") {
                let variant = format!("{name}, {}", told(&spec));
                let counts = rendering::run(&scene, spec, spp).counts;
                trials.same(variant, &(2 * counts.paths, counts.paths), &(counts.rays, counts.escaped));
            }
        }
    }
}

/// T = 12/13 of the light behind the slab and R = 1/13 of the light before it.
pub(super) fn slab_through_diagonals(trials: &mut Trials) {
    let up = [0.0, 1.0, 0.0];
    let [near, far] = [-100.3, 99.7];
    // The point below the camera is on both diagonals.
    let face = |y: f64, out: bool| {
        let [a, b, c, d] = [[near, y, near], [near, y, far], [far, y, far], [far, y, near]];
        quad(if out { [a, b, c, d] } else { [c, b, a, d] })
    };
    let black = diffuse(0.0);
    let scene = stage::scene(&[
        camera([0.37, 3.1, 0.37], [0.37, 1.0, 0.37]),
        object(&face(1.0, true), GLASS, [0.0; 3]),
        object(&face(0.1, false), GLASS, [0.0; 3]),
        object(&plane([0.0, -1.0, 0.0], up), &black, [1.0, 0.0, 1.0]),
        object(&plane([0.0, 5.0, 0.0], up), &black, [0.0, 1.0, 1.0]),
    ]);
    let spp = trials.times(256, 400_000) as u32;
    let limit = 4.5;
    for spec in ["smallpt", "bsdf"].into_iter().flat_map(specs) {
        let outcome = rendering::run(&scene, spec.clone(), spp);
        for (channel, exact) in [12.0 / 13.0, 1.0 / 13.0, 1.0].into_iter().enumerate() {
            let found = Moments::of(&outcome.film, channel);
            rendering::exact(trials, &format!("{}, channel {channel}", told(&spec)), exact, &found, limit, 0.2);
        }
    }
}
