//! The cone that a sphere subtends: H30, H31, H32.

use super::unguarded::{naive_one_minus_cos, naive_one_minus_cos_f32};
use super::warps::lit;
use crate::analysis::chi_square::against;
use crate::double_double::two_product;
use crate::math::{Vec3, dot};
use crate::sampling::{UNIFORM_SPHERE_DENSITY, mix, unit};
use crate::scene::one_minus_cos;
use crate::stage::sphere;
use crate::{Trials, U, critical};
use std::f64::consts::PI;

/// Distance in radii, 1 - cos, and the error of the naive form in double and in single precision.
const TABLE: [(f64, f64, f64, f64); 7] = [
    (2.0, 0.133_974_596_215_561_35, 4e-16, 1.2e-7),
    (100.0, 5.000_125_006_250_391e-5, 2.3e-13, 1.4e-4),
    (1e3, 5.000_001_250_000_625e-7, 6e-11, 0.073),
    (4096.0, 2.980_232_283_178_453_6e-8, 4e-16, 1.0),
    (1e4, 5.000_000_012_5e-9, 1.4e-8, 1.0),
    (1e6, 5.000_000_000_001_25e-13, 8.9e-5, 1.0),
    (1e8, 5.000_000_000_000_000_5e-17, 1.2, 1.0),
];

/// r²/(d² + d sqrt(d² - r²)), a form of 1 - cos in which only d² - r² cancels, in double-double arithmetic.
fn exact(radius: f64, distance: f64) -> f64 {
    let (square, r2) = (two_product(distance, distance), two_product(radius, radius));
    r2.over(square + two_product(distance, 1.0) * (square - r2).sqrt())
}

pub(super) fn digits(trials: &mut Trials) {
    for (distance, right, naive, naive_f32) in TABLE {
        for scale in [1.0, 1024.0, 1.0 / 1024.0] {
            let off = (one_minus_cos(scale, distance * scale) / right - 1.0).abs();
            trials.at_most(format!("{distance} radii, radius {scale}: roundings"), 8.0, off / U);
        }
        let off = (naive_one_minus_cos(1.0, distance) / right - 1.0).abs();
        trials.at_least(
            format!("{distance} radii, naive: relative error"),
            0.5 * naive * f64::from(u8::from(naive > 1e-14)),
            off,
        );
        let off = (f64::from(naive_one_minus_cos_f32(1.0, distance as f32)) / right - 1.0).abs();
        trials.at_least(format!("{distance} radii, naive in f32: relative error"), 0.5 * naive_f32, off);
    }
    // The series 1/(2 d²): the relative size of the next term is 1e-24.
    trials.at_most("1e12 radii: roundings", 8.0, (one_minus_cos(1.0_f64, 1e12) / 5e-25 - 1.0).abs() / U);
    let mut worst: f64 = 0.0;
    for k in 0..trials.times(100_000, 10_000_000) {
        // From 2^-40 to 2^40 radii above the sphere, uniform in the logarithm.
        let height = libm::exp2(80.0 * unit(mix(2 * k)) - 40.0);
        let radius = libm::exp2(40.0 * unit(mix(2 * k + 1)) - 20.0);
        let distance = radius * (1.0 + height);
        worst = worst.max((one_minus_cos(radius, distance) / exact(radius, distance) - 1.0).abs() / U);
    }
    trials.at_most("against twice the digits: roundings", 8.0, worst);
}

/// Inside the sphere the explicit formula takes the square root of a negative number. Uniform directions are right at
/// every point inside.
pub(super) fn inside(trials: &mut Trials) {
    let naive = naive_one_minus_cos(1.0, 0.5);
    trials.holds("naive, half a radius from the centre", "NaN", naive, naive.is_nan());
    let scene = lit(&sphere([0.0; 3], 1.0));
    let lights = scene.lights.as_ref().expect("a lit scene");
    let n = trials.times(40_000, 10_000_000);
    let limit = critical(12);
    for (place, x) in
        [("centre", 0.0), ("half way", 0.5), ("one rounding below the surface", 1.0 - U), ("on the surface", 1.0)]
    {
        let point = Vec3::new(x, 0.0, 0.0);
        let (mut wrong, mut cells) = (0, vec![0.0; 48]);
        for k in 0..n {
            let aim = lights.aim(point, None, || 0.5, [unit(mix(2 * k)), unit(mix(2 * k + 1))]);
            let Some(aim) = aim else {
                wrong += 1;
                continue;
            };
            wrong += u64::from(
                aim.density != UNIFORM_SPHERE_DENSITY || (dot(aim.direction, aim.direction) - 1.0).abs() > 4e-15,
            );
            // Heights on any axis are uniform.
            for (axis, height) in [aim.direction.x, aim.direction.y, aim.direction.z].into_iter().enumerate() {
                cells[16 * axis + (((0.5 + 0.5 * height) * 16.0) as usize).min(15)] += 1.0;
            }
        }
        trials.never(place, "aims without the density 1/4π or of another length than 1", wrong, n);
        for (axis, cells) in cells.chunks(16).enumerate() {
            let even = vec![n as f64 / 16.0; 16];
            trials.deviates_below(format!("{place}: heights on axis {axis}, chi-square"), limit, against(cells, &even));
        }
    }
}

/// d = r (1 + 2^-52): the cone fills nearly half of the sphere of directions, and the density matches it.
pub(super) fn touching(trials: &mut Trials) {
    let distance = 1.0 + f64::EPSILON;
    // cos = sqrt((d - r)(d + r))/d, about sqrt(2^-51).
    let right = 1.0 - 2.107_342_425_544_701_7e-8;
    trials.close("1 - cos", right, one_minus_cos(1.0, distance), 4.0 * U);
    trials.close("1 - cos on the surface", 1.0, one_minus_cos(1.0, 1.0), 0.0);
    let scene = lit(&sphere([0.0; 3], 1.0));
    let lights = scene.lights.as_ref().expect("a lit scene");
    let (mut wrong, n) = (0, trials.times(20_000, 1_000_000));
    let last = 1.0 - U;
    let extremes = [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last]];
    for k in 0..n {
        let u = extremes.get(k as usize).copied().unwrap_or([unit(mix(2 * k)), unit(mix(2 * k + 1))]);
        let point = Vec3::new(0.0, distance, 0.0);
        let is_fine = lights.aim(point, None, || 0.5, u).is_some_and(|aim| {
            let is_unit = (dot(aim.direction, aim.direction) - 1.0).abs() < 4e-15;
            is_unit && aim.direction.y < 0.0 && (aim.density * 2.0 * PI - 1.0 / right).abs() < 1e-15
        });
        wrong += u64::from(!is_fine);
    }
    trials.never("aims", "densities off 1/(2π (1 - cos)), or directions upwards", wrong, n);
    for distance in [1.0 + U, 1.0, 1.0 - U] {
        let aim = lights.aim(Vec3::new(0.0, distance, 0.0), None, || 0.5, [0.3, 0.7]);
        let is_fine = aim.is_none_or(|aim| aim.density > 0.0 && aim.density.is_finite());
        trials.holds(format!("from {distance:?} radii"), "a density above 0", format!("{aim:?}"), is_fine);
    }
}
