//! Fresnel's equations and Schlick's approximation: H10, H11, H12.

use super::unguarded::schlick;
use crate::math::{Vec3, dot, fresnel_dielectric, fresnel_schlick, refract};
use crate::refusals::refused;
use crate::sampling::{mix, unit};
use crate::{Trials, U};

const N: f64 = 1.5;
/// Cosine, reflectance from outside, reflectance from inside; computed with mpmath.
const TABLE: [(f64, f64, f64); 5] = [
    (1.0, 0.04, 0.04),
    (0.9, 0.040_791_887_937_218_35, 0.046_332_647_954_037_666),
    (0.8, 0.043_894_736_003_448_23, 0.114_141_100_221_353_94),
    (0.75, 0.046_780_747_425_307_426, 0.5),
    (0.5, 0.089_186_712_802_212_78, 1.0),
];

/// The same by Schlick's polynomial, computed by hand in decimals.
const SCHLICK: [(f64, f64, f64); 7] = [
    (1.0, 0.04, 0.04),
    (0.9, 0.040_009_6, 0.040_819_485_607_2),
    (0.8, 0.040_307_2, 0.094_839_139_6),
    (0.75, 0.040_937_5, 0.532_392_578_125),
    (0.5, 0.07, 1.0),
    (0.25, 0.267_812_5, 1.0),
    (0.1, 0.606_870_4, 1.0),
];

/// Index of the far side over index of the near side, cosine, reflectance: 202 rows of decimal numbers.
pub(crate) fn oracle() -> Vec<(f64, f64, f64)> {
    let text = include_str!("../../data/fresnel-oracle.json");
    let rows: Vec<[String; 3]> = serde_json::from_str(text).expect("the file of the oracle is well formed");
    let number = |text: &str| match text {
        "1/1.5" => 1.0 / N,
        other => other.parse().expect("a number"),
    };
    rows.iter().map(|[eta, cos, expected]| (number(eta), number(cos), number(expected))).collect()
}

pub(super) fn values(trials: &mut Trials) {
    let rows = oracle();
    trials.same("rows of the oracle", &202, &rows.len());
    // From inside, the value varies with the root of the distance to the critical cosine, 0.7454, so it is very steep
    // at 0.75.
    let errors = rows.iter().map(|(eta, cos, expected)| (fresnel_dielectric(*cos, *eta) - expected).abs());
    trials.at_most("oracle: largest error", 2e-15, errors.fold(0.0, f64::max));
    for (cos, outside, inside) in TABLE {
        trials.close(format!("cos {cos} from outside"), outside, fresnel_dielectric(cos, N), 2e-15);
        trials.close(format!("cos {cos} from inside"), inside, fresnel_dielectric(cos, 1.0 / N), 2e-15);
    }
    for (cos, outside, inside) in SCHLICK {
        trials.close(format!("Schlick, cos {cos} from outside"), outside, fresnel_schlick(cos, 0.04), 1e-15);
        trials.close(format!("Schlick, cos {cos} from inside"), inside, schlick(cos, 1.0 / N), 1e-9);
    }
    next_to_the_critical_angle(trials);
    diffuse_reflectances(trials);
    how_far_off_schlick_is(trials);
}

/// R is continuous at cosine sqrt(5)/3, with an infinite slope: k roundings away, 1 - R is right within 4e-7 sqrt(k).
fn next_to_the_critical_angle(trials: &mut Trials) {
    let critical = 0.745_355_992_499_929_9;
    for (k, expected) in [(1.0, 1.12e-7), (2.0, 1.59e-7), (10.0, 3.55e-7), (1000.0, 3.55e-6)] {
        let step = k * U;
        let rest = 1.0 - fresnel_dielectric(critical + step, 1.0 / N);
        trials.close(format!("1 - R {k} roundings above the critical cosine"), expected, rest, 4e-7 * f64::sqrt(k));
        let below = 1.0 - fresnel_dielectric(critical - step, 1.0 / N);
        trials.close(format!("1 - R {k} roundings below"), 0.0, below, 4e-7 * f64::sqrt(k));
    }
    trials.close("total reflection", 1.0, fresnel_dielectric(0.7, 1.0 / N), 0.0);
    let towards = |cos: f64| Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut wrong = 0;
    for k in 1..1000_u32 {
        let step = f64::from(k) * f64::EPSILON;
        let (above, cos2) = refract(towards(critical + step), N);
        let is_fine = cos2 >= 0.0 && above.z <= 0.0 && above.x.is_finite();
        wrong += u64::from(!is_fine || refract(towards(critical - step), N).1 >= 0.0);
    }
    trials.never("1000 neighbours of the critical cosine", "refracted where all is reflected, or NaN", wrong, 999);
}

/// The mean over the hemisphere, weighted by the cosine, by the midpoint rule.
fn diffuse(eta: f64, reflectance: fn(f64, f64) -> f64) -> f64 {
    let n = 1 << 20;
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    (0..n).map(|k| 2.0 * at(k) * reflectance(at(k), eta)).sum::<f64>() / f64::from(n)
}

/// Both diffuse reflectances are known, and 1 - r(inside) = (1 - r(outside))/n² relates them. The slope at the
/// critical angle costs the midpoint rule some digits.
fn diffuse_reflectances(trials: &mut Trials) {
    let (outside, inside) = (diffuse(N, fresnel_dielectric), diffuse(1.0 / N, fresnel_dielectric));
    trials.close("diffuse, from outside", 0.091_777_959_342_351_21, outside, 1e-9);
    trials.close("diffuse, from inside", 0.596_345_759_707_711_6, inside, 1e-8);
    trials.close("(1 - inside) n² + outside", 1.0, (1.0 - inside) * N * N + outside, 2e-8);
    trials.close("Schlick, diffuse, from outside", 6.0 / 70.0, diffuse(N, schlick), 1e-9);
}

/// Schlick's largest error among thousandths: 0.0356922 at cosine 0.088 from outside, and 0.0355694 at 0.748 from
/// inside.
fn how_far_off_schlick_is(trials: &mut Trials) {
    for (side, eta, expected, where_) in [("outside", N, 0.035_692_2, 0.088), ("inside", 1.0 / N, 0.035_569_4, 0.748)] {
        let errors = (0..=1000).map(|k| f64::from(k) / 1000.0);
        let errors = errors.map(|cos| ((schlick(cos, eta) - fresnel_dielectric(cos, eta)).abs(), cos));
        let (error, cos) = errors.fold((0.0, 0.0), |worst, this| if this.0 > worst.0 { this } else { worst });
        trials.close(format!("Schlick, largest error from {side}"), expected, error, 1e-6);
        trials.close(format!("Schlick, where that is, from {side}"), where_, cos, 1.1e-3);
    }
}

pub(super) fn indices(trials: &mut Trials) {
    let above = 1.0 + f64::EPSILON;
    for cos in [0.0, -0.0, 1e-150, 1e-8, 0.3, 1.0, above] {
        trials.close(format!("equal indices, cos {cos:?}"), 0.0, fresnel_dielectric(cos, 1.0), 0.0);
    }
    for cos in [0.1, 0.3, 0.9, 1.0] {
        // A step of one rounding reflects at most (step/(4 cos²))².
        for eta in [above, 1.0 - U] {
            trials.at_most(format!("index {eta:?}, cos {cos}"), 1.3e-28, fresnel_dielectric(cos, eta));
        }
        let wo = Vec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
        let (straight, _) = refract(wo, 1.0);
        let off = straight + wo;
        trials.at_most(format!("bent by equal indices, cos {cos}: roundings"), 4.0 / cos, dot(off, off).sqrt() / U);
    }
    // ((n - 1)/(n + 1))², about 0.7320.
    let root = 11.85 / 13.85;
    trials.close("index 12.85 (second report)", root * root, fresnel_dielectric(1.0, 12.85), 1e-15);
    for material in ["{ dielectric = { eta = VALUE, tint = [1.0, 1.0, 1.0] } }", "{ fresnel-mirror = { eta = VALUE } }"]
    {
        for value in ["0.0", "-1.0", "nan", "inf", "0.009", "101.0"] {
            refused(trials, material, "eta", value, "0.01 to 100");
        }
    }
}

pub(super) fn cosines(trials: &mut Trials) {
    let above = 1.0 + f64::EPSILON;
    let (mut outside, mut n) = (0, 0);
    for cos in [0.0, -0.0, 5e-324, 1e-150, 1e-8, 0.3, 1.0 - U, 1.0, above, -above] {
        for eta in [N, 1.0 / N, 12.85, 1.0 / 12.85, 0.01, 100.0, above, 1.0 - U] {
            n += 1;
            outside += u64::from(!(0.0..=1.0).contains(&fresnel_dielectric(cos, eta)));
        }
    }
    trials.never("extreme cosines and indices", "reflectances outside of 0 to 1", outside, n);
    trials.close("cos 0", 1.0, fresnel_dielectric(0.0, N), 0.0);
    trials.close("cos -0", 1.0, fresnel_dielectric(-0.0, N), 0.0);
    let (mut worst, mut uneven): (f64, f64) = (0.0, 0.0);
    for k in 0..trials.times(100_000, 10_000_000) {
        let (cos, eta) = (unit(mix(2 * k)), 1.0 + 2.0 * unit(mix(2 * k + 1)));
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let (into, cos2) = refract(wo, 1.0 / eta);
        let (back, _) = refract(-into, eta);
        // A refracted direction refracts back to itself, within the rounding error that steep angles amplify.
        worst = worst.max((back.x + wo.x).abs() * cos2.sqrt() / U);
        let share = (fresnel_dielectric(cos, eta) - fresnel_dielectric(-into.z, 1.0 / eta)).abs();
        uneven = uneven.max(share / (1e-14 + 1e-14 / cos));
    }
    trials.at_most("there and back, roundings times the far cosine", 8.0, worst);
    trials.at_most("reflectance from both sides, in 1e-14 (1 + 1/cos)", 1.0, uneven);
}
