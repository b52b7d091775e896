//! Densities and the weights of the power heuristic that are computed from them: H33, H34.

use super::unguarded::power_heuristic_by_squares;
use crate::Trials;
use crate::bare_scene::every_scene;
use crate::estimator::power_heuristic;
use crate::material::Density;
use crate::materials::{every_material, towards};
use crate::sampling::{mix, unit};
use crate::scene::AllEffects;

/// Where a material has a nonzero value, it has a density. Samples have a finite density, or are deltas, which cannot
/// be evaluated. Aims at lights have a finite density in every scene of the program.
pub(super) fn densities(trials: &mut Trials) {
    let n = trials.times(20_000, 1_000_000);
    for (number, (name, material)) in (0..).zip(every_material()) {
        let (mut without, mut endless, mut with_value) = (0, 0, 0);
        for k in 0..n {
            let u: [f64; 6] = std::array::from_fn(|i| unit(mix((number << 48) + 6 * k + i as u64)));
            // Every third pair is grazing.
            let near = |cos: f64| if k % 3 == 0 { cos * 1e-9 } else { cos };
            let (wo, wi) = (towards(near(u[0]), u[1]), towards(near(u[2]), u[3]));
            if !material.eval::<AllEffects>(wo, wi).is_black() {
                with_value += 1;
                let pdf = material.pdf::<AllEffects>(wo, wi);
                without += u64::from(!(pdf > 0.0 && pdf.is_finite()));
            }
            if let Some(sample) = material.sample::<AllEffects>(wo, false, [u[4], u[5]]) {
                endless += u64::from(
                    match sample.density {
                        Density::Delta => material.delta_lobes::<AllEffects>(wo, false)[0].is_none(),
                        Density::PerSolidAngle(density) => !(density > 0.0 && density.is_finite()),
                    } || !sample.weight.is_valid_radiance(),
                );
            }
        }
        trials.holds(format!("{name}: value without density"), "0", format!("{without} of {with_value}"), without == 0);
        trials.never(name, "samples without a density or a weight that is finite", endless, n);
    }
    aims(trials);
}

/// Aims from points that the camera sees, and from half way to them.
fn aims(trials: &mut Trials) {
    let (mut wrong, mut n) = (0, 0);
    let rays = trials.times(100, 10_000) as u32;
    for scene in every_scene() {
        let view = scene.camera.view(64, 48);
        let scene = scene.lit(&view);
        let Some(lights) = &scene.lights else { continue };
        for k in 0..rays {
            let ray = view.ray::<AllEffects>(k * 7 % 64, k * 5 % 48, 0, [0.5, 0.5], || [0.5, 0.5]);
            let Some(hit) = scene.first_of_any(&ray, None) else { continue };
            for point in [ray.at(0.5 * hit.t), hit.point] {
                let u: [f64; 3] = std::array::from_fn(|i| unit(mix(u64::from(3 * k) + i as u64)));
                if let Some(aim) = lights.aim(point, None, || u[2], [u[0], u[1]]) {
                    n += 1;
                    wrong += u64::from(!(aim.density > 0.0 && aim.density.is_finite()));
                }
            }
        }
    }
    trials.never("aims in every scene", "densities of 0 or without an end", wrong, n);
}

/// Squares of 1e300 overflow and squares of 1e-300 underflow, so computing with squares gives NaN weights.
pub(super) fn shares(trials: &mut Trials) {
    let magnitudes = [0.0, 5e-324, 1e-300, 1e-160, 1e-8, 0.3, 1.0, 7.0, 1e8, 1e160, 1e300, f64::MAX];
    let (mut worst, mut by_squares): (f64, u64) = (0.0, 0);
    let off = |a: f64, b: f64| {
        let off = (power_heuristic(a, b) + power_heuristic(b, a) - 1.0).abs();
        if off.is_nan() { f64::INFINITY } else { off }
    };
    for a in magnitudes {
        for b in magnitudes.into_iter().filter(|b| a > 0.0 || *b > 0.0) {
            worst = worst.max(off(a, b));
            by_squares += u64::from(power_heuristic_by_squares(a, b).is_nan());
        }
    }
    trials.at_most("magnitudes from 0 to 1.8e308: sum off 1", f64::EPSILON, worst);
    trials.at_least("by squares: shares that are NaN", 1.0, by_squares as f64);
    let mut worst: f64 = 0.0;
    for k in 0..trials.times(500_000, 10_000_000) {
        let [a, b] = [2 * k, 2 * k + 1].map(|k| libm::exp2(2000.0 * unit(mix(k)) - 1000.0));
        let near = b * libm::exp2(8.0 * unit(mix(!k)) - 4.0);
        worst = worst.max(off(a, b)).max(off(b, near));
    }
    trials.at_most("random magnitudes: sum off 1", f64::EPSILON, worst);
    for (a, b, expected) in
        [(1.0, 0.0, 1.0), (0.0, 1.0, 0.0), (3.0, 1.0, 0.9), (1e300, 1e300, 0.5), (3e-300, 1e-300, 0.9)]
    {
        trials.close(format!("share of {a:e} beside {b:e}"), expected, power_heuristic(a, b), 1e-15);
    }
}
