//! Reciprocity and albedo of materials: H26.

use super::unguarded::{albedo_by_cosines, albedo_by_normals, albedo_by_visible_normals};
use crate::material::{Ggx, Material};
use crate::materials::{every_material, towards};
use crate::math::{Vec3, fresnel_dielectric};
use crate::refusals::material;
use crate::sampling::{mix, uniform_sphere, unit};
use crate::scene::AllEffects;
use crate::{Trials, critical};

fn direction(key: u64) -> Vec3 {
    let d = uniform_sphere([unit(mix(2 * key)), unit(mix(2 * key + 1))]).normalized();
    Vec3 { z: d.z.abs(), ..d }
}

pub(super) fn balance(trials: &mut Trials) {
    reciprocity(trials);
    albedos_of_the_table(trials);
    mean_weights(trials);
    ways_agree(trials);
}

/// Checks f(a, b) = f(b, a) where the model is reciprocal. `kd-ks` is not: f(a, b)/f(b, a) equals F(a)/F(b).
fn reciprocity(trials: &mut Trials) {
    let n = trials.times(20_000, 1_000_000);
    let off =
        |there: f64, back: f64| if there.max(back) > 1e-300 { (there - back).abs() / there.max(back) } else { 0.0 };
    for (name, material) in every_material().into_iter().filter(|(_, material)| material.is_reciprocal()) {
        let mut worst: f64 = 0.0;
        for k in 0..n {
            let [a, b] = [direction(2 * k), direction(2 * k + 1)];
            let (there, back) = (material.eval::<AllEffects>(a, b), material.eval::<AllEffects>(b, a));
            let channels = there.channels().into_iter().zip(back.channels());
            worst = channels
                .map(|(there, back)| off(there, back))
                .fold(worst, |worst, this| if this <= worst { worst } else { this });
        }
        trials.at_most(format!("{name}: f(a, b) against f(b, a)"), 1e-12, worst);
    }
    let facets = material("{ kd-ks = { kd = [0.0, 0.0, 0.0], eta = 12.85, roughness = 0.5 } }");
    let (mut worst, mut widest): (f64, f64) = (0.0, 1.0);
    for k in 0..n {
        let [a, b] = [direction(2 * k), direction(2 * k + 1)];
        let ratio = facets.eval::<AllEffects>(a, b).r / facets.eval::<AllEffects>(b, a).r;
        worst = worst.max(off(ratio, fresnel_dielectric(a.z, 12.85) / fresnel_dielectric(b.z, 12.85)));
        widest = widest.max(ratio);
    }
    trials.at_most("kd-ks: f(a, b)/f(b, a) against F(a)/F(b)", 1e-12, worst);
    trials.at_least("kd-ks: largest f(a, b)/f(b, a)", 1.3, widest);
}

/// Cosines of the viewing angle.
pub(crate) const COSINES: [f64; 6] = [1.0, 0.75, 0.5, 0.25, 0.1, 0.05];

/// Roughness, and the albedo of facets with F = 1 at each cosine: single scattering by GGX with height-correlated
/// shadowing, by quadrature with mpmath to 1e-6. The last row at normal incidence is 1 - ln 2.
pub(crate) const ALBEDO: [(f64, [f64; 6]); 7] = [
    (0.01, [0.999_899, 0.999_858, 0.999_742, 0.999_092, 0.994_124, 0.976_208]),
    (0.05, [0.997_296, 0.996_138, 0.992_716, 0.974_512, 0.911_347, 0.889_894]),
    (0.1, [0.988_304, 0.983_144, 0.969_205, 0.921_623, 0.883_455, 0.911_763]),
    (0.25, [0.915_812, 0.891_533, 0.857_263, 0.840_082, 0.891_622, 0.933_132]),
    (0.5, [0.687_849, 0.682_083, 0.698_251, 0.765_203, 0.860_105, 0.912_548]),
    (0.75, [0.463_917, 0.501_411, 0.564_623, 0.680_248, 0.810_714, 0.880_610]),
    (1.0, [0.306_852_819_440_054_7, 0.364_527, 0.450_694, 0.597_641, 0.760_211, 0.847_774]),
];

/// The fractional parts of multiples of these fill the square evenly: powers of the reciprocal root of x³ = x + 1
/// (Roberts, 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

fn white(alpha: f64) -> Material {
    material(&format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 1.0, 1.0] }} }}"))
}

/// Compares sampling, and the quadrature behind scenes in equilibrium, with the table. At α = 1 and normal incidence
/// the albedo is 1 - ln 2.
fn albedos_of_the_table(trials: &mut Trials) {
    let n = trials.times(50_000, 1_000_000);
    let quadrature = |alpha: f64, cos: f64| white(alpha).albedo_at(cos).map_or(f64::NAN, |albedo| albedo.r);
    for (alpha, row) in ALBEDO {
        let white = white(alpha);
        for (cos, expected) in COSINES.into_iter().zip(row) {
            let mut sum = 0.0;
            for k in 0..n {
                let u = STEPS.map(|step| (k as f64 * step).fract());
                let found = white.sample::<AllEffects>(towards(cos, 0.0), false, u);
                sum += found.map_or(0.0, |found| found.weight.r) / n as f64;
            }
            trials.close(format!("alpha {alpha}, cos {cos}: sampled"), expected, sum, 4e-4 * expected);
            trials.close(format!("alpha {alpha}, cos {cos}: quadrature"), expected, quadrature(alpha, cos), 1e-4);
        }
    }
    for (alpha, expected) in [(1e-4, 0.999_999_989_998_664_1), (1e-3, 0.999_998_998_648_7), (0.01, 0.999_898_556_406)] {
        trials.close(format!("alpha {alpha}, cos 1: quadrature"), expected, quadrature(alpha, 1.0), 1e-4);
    }
}

/// For every material and its sampling method, the mean weight is the share of light that it scatters: at most 1.
fn mean_weights(trials: &mut Trials) {
    let materials = every_material();
    let cosines = [1.0, 0.6, 0.2];
    let limit = critical(materials.len() * cosines.len());
    let n = trials.times(20_000, 2_000_000);
    for (number, (name, material)) in (0..).zip(&materials) {
        for cos in cosines {
            let (mut sum, mut square) = (0.0, 0.0);
            for k in 0..n {
                let key = mix(number << 40 | k);
                let found = material.sample::<AllEffects>(towards(cos, 0.0), false, [unit(key), unit(mix(key))]);
                let weight = found.map_or(0.0, |found| found.weight.r);
                sum += weight;
                square += weight * weight;
            }
            let mean = sum / n as f64;
            let error = ((square / n as f64 - mean * mean).max(0.0) / n as f64).sqrt();
            let albedo = material.albedo_at(cos).unwrap_or(material.albedo::<AllEffects>());
            let is_share = (0.0..=1.0 + 1e-4).contains(&albedo.max_channel());
            trials.holds(format!("{name}, cos {cos}: albedo"), "0 to 1", format!("{albedo:?}"), is_share);
            // The quadrature has an error, too.
            trials.close(format!("{name}, cos {cos}: mean weight"), albedo.r, mean, limit * error + 1e-4);
        }
    }
}

/// Three sampling methods agree on the albedo. On glossy surfaces, visible normals have the smallest variance.
fn ways_agree(trials: &mut Trials) {
    let n = trials.times(50_000, 10_000_000);
    let limit = critical(6);
    for (alpha, cos, least) in [(0.1, 0.75, 100.0), (0.25, 0.75, 10.0), (0.5, 0.5, 2.0)] {
        let ggx = Ggx::new(alpha).expect("a roughness that is allowed");
        let quiet = albedo_by_visible_normals(ggx, cos, n);
        for (way, found) in
            [("cosines", albedo_by_cosines(ggx, cos, n)), ("all normals", albedo_by_normals(ggx, cos, n))]
        {
            let variant = format!("alpha {alpha}, cos {cos}, visible normals and {way}");
            let error = libm::hypot(quiet.standard_error(n), found.standard_error(n));
            trials.deviates_below(variant, limit, (quiet.mean - found.mean) / error);
        }
        let ratio = albedo_by_cosines(ggx, cos, n).variance / quiet.variance;
        trials.at_least(format!("alpha {alpha}, cos {cos}: variance by cosines over visible normals"), least, ratio);
    }
}
