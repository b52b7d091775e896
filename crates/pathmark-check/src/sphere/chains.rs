//! Paths that never end.

use super::short_ways::scatter;
use crate::Trials;
use crate::bare_scene::{intersect, searches};
use crate::math::{Ray, Vec3, dot};
use crate::stage::{ANY_CAMERA, MIRROR, ball, try_scene};

/// Without renormalising, |d| must stay 1 within 1e-12. With it, as in paths, every chord is as long as the first: 2 r
/// cos.
pub(super) fn mirror_chain(trials: &mut Trials) {
    let parts = [ANY_CAMERA.to_string(), ball("room", [50.0, 40.8, 81.6], 1e5, MIRROR)];
    let room = try_scene(&parts).expect("a right scene");
    for (name, scene) in searches(&room) {
        for renormalise in [false, true] {
            let direction = Vec3::new(0.3, -0.2, 0.93).normalized();
            let mut ray = Ray { origin: Vec3::new(70_000.0, 30_000.0, -10_000.0), direction };
            let (mut from, mut first, mut bounces) = (None, None, 0);
            let (mut drift, mut stretch) = (0.0_f64, 0.0_f64);
            while bounces < 10_000 {
                let Some(hit) = intersect(&scene, &ray, from) else { break };
                if bounces > 0 {
                    stretch = stretch.max((hit.t / *first.get_or_insert(hit.t) - 1.0).abs());
                }
                let (next, standpoint) = scatter(&scene, &hit, ray.direction, 0.0);
                drift = drift.max((dot(next.direction, next.direction).sqrt() - 1.0).abs());
                ray = if renormalise { Ray { direction: next.direction.normalized(), ..next } } else { next };
                from = Some(standpoint);
                bounces += 1;
            }
            let how = if renormalise { "renormalised" } else { "as reflected" };
            let variant = format!("{how}, accelerator {name}");
            trials.same(format!("{variant}, bounces"), &10_000, &bounces);
            trials.close(format!("{variant}, ||d| - 1|"), 0.0, drift, 1e-12);
            if renormalise {
                trials.close(format!("{variant}, chords"), 0.0, stretch, 1e-11);
            }
        }
    }
}
