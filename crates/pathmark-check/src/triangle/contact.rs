//! The contact point of a ball and the floor: hits that are nearer than any noise threshold count.

use crate::bare_scene::{intersect, searches};
use crate::estimator::ESTIMATORS;
use crate::exact::mean;
use crate::kernel::{KERNELS, Spec};
use crate::math::{Ray, Vec3, dot};
use crate::random::Random;
use crate::rendering::{by_kernel, try_render};
use crate::scene::{Scene, SurfaceOrigin};
use crate::stage::{ball, camera, named, try_scene};
use crate::{Trials, U, critical};
use std::f64::consts::PI;
use std::sync::Arc;

/// Distance of the point from the contact of the unit ball.
const AWAY: f64 = 0.1;

/// A ball that touches the floor, seen at the point 0.1 from the contact, under the ball: the camera's direction rises
/// by 6 of the 11 degrees that are free.
fn scene(before: &str, glow: f64, after: &str) -> Arc<Scene> {
    let parts = [
        before.to_string(),
        camera([3.0, 0.3, 0.0], [AWAY, 0.0, 0.0]),
        named(
            "ball",
            "{ sphere = { center = [0.0, 1.0, 0.0], radius = 1.0 } }",
            "{ diffuse = { albedo = [0.0, 0.0, 0.0] } }",
            glow,
        ),
        named(
            "floor",
            "{ plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] } }",
            "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }",
            0.0,
        ),
        after.to_string(),
    ];
    Arc::new(try_scene(&parts).expect("a right scene"))
}

pub(super) fn contact(trials: &mut Trials) {
    // The ball touches the horizon and lies wholly above it: its share of the light from a white sky is (r/d)² cos =
    // 1/d³.
    let share = 1.0 / ((1.0 + AWAY * AWAY) * (1.0 + AWAY * AWAY).sqrt());
    let glowing = scene("background = [0.0, 0.0, 0.0]\n", 1.0, "");
    directions(trials, &glowing);
    let sky = scene("background = [1.0, 1.0, 1.0]\n", 0.0, "");
    // One light behind the ball: the way to it enters the ball after 0.01. Another light on the near side, as low as
    // the camera.
    let light = |x: f64, y: f64| {
        let text = format!("[[point-lights]]\nposition = [{x:?}, {y:?}, 0.0]\nintensity = [1.0, 1.0, 1.0]\n");
        // A ball behind the light does not hide it.
        let black = "{ diffuse = { albedo = [0.0, 0.0, 0.0] } }";
        let behind = ball("behind", [1.6 * x, 1.6 * y, 0.0], 0.2 * x.abs(), black);
        scene("background = [0.0, 0.0, 0.0]\n", 0.0, &(text + &behind))
    };
    let squared = (5.0 - AWAY) * (5.0 - AWAY) + 0.25;
    let lit = 0.5 / PI * 0.5 / (squared * squared.sqrt());
    let critical = critical(2 * ESTIMATORS.len() * KERNELS.len());
    let spec = Spec { width: 32, height: 32, seed: 18, ..Spec::default() };
    let spp = trials.times(64, 4096) as u32;
    for estimator in ESTIMATORS {
        for spec in by_kernel(&Spec { estimator: estimator.name.into(), ..spec.clone() }) {
            let who = format!("{}, {}", spec.estimator, spec.kernel);
            for (what, scene, expected) in [("hidden light", light(-5.0, 3.0), 0.0), ("light", light(5.0, 0.5), lit)] {
                let Some(outcome) = try_render(trials, &scene, spec.clone(), 4) else { continue };
                // All pixels see points within 3e-7 of each other.
                trials.close(format!("{what}, {who}"), expected, mean(&outcome.film, 0).0, 1e-6 * expected);
            }
            if spec.estimator == "whitted" {
                trials.skip("whitted, ball and sky: it takes no light by way of diffuse surfaces");
                continue;
            }
            for (what, scene, expected) in [("glowing ball", &glowing, 0.5 * share), ("sky", &sky, 0.5 * (1.0 - share))]
            {
                let Some(outcome) = try_render(trials, scene, spec.clone(), spp) else { continue };
                let (found, error) = mean(&outcome.film, 0);
                trials.deviates_below(format!("{what}, {who}, {found:.6}"), critical, (found - expected) / error);
                let told = format_args!("{:.1} standard errors", expected / error);
                trials.holds(
                    format!("{what}, {who}"),
                    "12 standard errors from nothing",
                    told,
                    expected > 12.0 * error,
                );
            }
        }
    }
}

/// A direction from the point hits the ball exactly if it lies within the cone of the ball. A third of the hits are
/// nearer than 0.5.
fn directions(trials: &mut Trials, scene: &Arc<Scene>) {
    let rays = trials.times(100_000, 10_000_000);
    let point = Vec3::new(AWAY, 0.0, 0.0);
    let towards = Vec3::new(-AWAY, 1.0, 0.0).normalized();
    // sin of the cone's half angle is 1/d.
    let cos = AWAY / (1.0 + AWAY * AWAY).sqrt();
    for (name, scene) in searches(scene) {
        let mut random = Random::new(18);
        let (mut wrong, mut near) = (0, 0);
        for _ in 0..rays {
            let any = random.direction();
            let direction = if any.y < 0.0 { -any } else { any };
            let from = Some(SurfaceOrigin { primitive: 1, inside: false });
            let hit = intersect(&scene, &Ray { origin: point, direction }, from);
            let beyond = dot(direction, towards) - cos;
            wrong += u64::from(hit.is_some() != (beyond > 0.0) && beyond.abs() > 64.0 * U);
            near += u64::from(hit.is_some_and(|hit| hit.t < 0.5));
        }
        trials.never(format!("directions, accelerator {name}"), "hits and misses mistaken", wrong, rays);
        let told = format_args!("{near} of {rays}");
        trials.holds("directions", "a third meet the ball nearer than 0.5", told, 3 * near > rays);
    }
}
