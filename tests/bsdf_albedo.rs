//! How much light comes back from GGX facets that reflect everything: the table of directional albedos, worked out with mpmath to 1e-6, against
//! 1e6 samples of `conductor` (within 0.02 %: numbers that fill the square more evenly than random ones) and against the quadrature that scenes in equilibrium are built on. At α = 1 and normal
//! incidence the closed form is 1 - ln 2.

#[path = "support/materials.rs"]
mod materials;

use materials::{every_material, material};
use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::material::Material;
use pathmark::math::Vec3;
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};
use pathmark::scene::AllEffects;

const LEVEL: f64 = 1e-3;
const SAMPLES: u32 = 1_000_000;
/// Multiples of these, less their whole parts, fill the square evenly: the powers of the root of x³ = x + 1 (Roberts, 2018).
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
const COSINES: [f64; 6] = [1.0, 0.75, 0.5, 0.25, 0.1, 0.05];

/// Roughness, and the albedo at each cosine.
const TABLE: [(f64, [f64; 6]); 6] = [
    (0.05, [0.997_296, 0.996_138, 0.992_716, 0.974_512, 0.911_347, 0.889_894]),
    (0.1, [0.988_304, 0.983_144, 0.969_205, 0.921_623, 0.883_455, 0.911_763]),
    (0.25, [0.915_812, 0.891_533, 0.857_263, 0.840_082, 0.891_622, 0.933_132]),
    (0.5, [0.687_849, 0.682_083, 0.698_251, 0.765_203, 0.860_105, 0.912_548]),
    (0.75, [0.463_917, 0.501_411, 0.564_623, 0.680_248, 0.810_714, 0.880_610]),
    (1.0, [0.306_853, 0.364_527, 0.450_694, 0.597_641, 0.760_211, 0.847_774]),
];

fn white(alpha: f64) -> Material {
    material(&format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 1.0, 1.0] }} }}"))
}

fn towards(cos: f64) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)
}

/// Mean and standard error of the weight of the red channel.
fn mean_weight(material: &Material, cos: f64, samples: u32, seed: u64) -> (f64, f64) {
    let (mut sum, mut square) = (0.0, 0.0);
    for sample in 0..samples {
        let key = SampleKey { seed, pixel: 0, sample };
        let u = Independent.pair(Address { key, bounce: 1, branch: 0, purpose: Purpose::Bsdf });
        let weight = material.sample::<AllEffects>(towards(cos), false, u).map_or(0.0, |found| found.weight.r);
        sum += weight;
        square += weight * weight;
    }
    let n = f64::from(samples);
    (sum / n, (square / n - sum * sum / n / n).max(0.0).sqrt() / n.sqrt())
}

#[test]
fn samples_reach_the_table() {
    for (alpha, row) in TABLE {
        let material = white(alpha);
        for (cos, expected) in COSINES.into_iter().zip(row) {
            let mut sum = 0.0;
            for k in 0..SAMPLES {
                let u = STEPS.map(|step| (f64::from(k) * step).fract());
                let weight = material.sample::<AllEffects>(towards(cos), false, u).map_or(0.0, |found| found.weight.r);
                sum += weight / f64::from(SAMPLES);
            }
            assert!((sum / expected - 1.0).abs() < 2e-4, "alpha {alpha}, cosine {cos}: {sum}, not {expected}");
        }
    }
}

#[test]
fn the_quadrature_reaches_the_table() {
    let closed = 1.0 - std::f64::consts::LN_2;
    let at_one = white(1.0).albedo_at(1.0).unwrap().r;
    assert!((at_one - closed).abs() < 1e-4, "{at_one}, not 1 - ln 2 = {closed}");
    for (alpha, row) in TABLE {
        for (cos, expected) in COSINES.into_iter().zip(row) {
            let found = white(alpha).albedo_at(cos).unwrap().r;
            assert!((found - expected).abs() < 1e-4, "alpha {alpha}, cosine {cos}: {found}, not {expected}");
        }
    }
    for (alpha, expected) in [(1e-4, 0.999_999_99), (1e-3, 0.999_999), (0.01, 0.999_898_6)] {
        let found = white(alpha).albedo_at(1.0).unwrap().r;
        assert!((found - expected).abs() < 1e-4, "alpha {alpha}: {found}, not {expected}");
    }
}

/// Whatever the material and its way of choosing directions: the mean weight is the share of light that it scatters, and that is at most 1.
#[test]
fn mean_weights_are_albedos() {
    let materials = every_material();
    let cosines = [1.0, 0.6, 0.2];
    let limit = critical_value(sidak(LEVEL, materials.len() * cosines.len()).unwrap()).unwrap();
    for (name, material) in &materials {
        for cos in cosines {
            let (found, error) = mean_weight(material, cos, 100_000, 32);
            let albedo = material.albedo_at(cos).unwrap_or(material.albedo::<AllEffects>());
            assert!((0.0..=1.0 + 1e-4).contains(&albedo.max_channel()), "{name}, cosine {cos}: {albedo:?}");
            // The quadrature has an error too.
            let far = (found - albedo.r).abs();
            assert!(far <= limit * error + 1e-4, "{name}, cosine {cos}: {found}, not {}, {}", albedo.r, far / error);
        }
    }
}

/// Both ways of choosing directions estimate the same, and the facets' way is the quieter one where there is a gloss.
#[test]
fn visible_normals_are_quieter_than_cosines() {
    for (roughness, least) in [(0.1, 10.0), (0.25, 3.0)] {
        let of = |kind: &str| {
            let text = format!(
                "{{ kd-ks = {{ kd = [0.3, 0.3, 0.25], eta = 12.85, roughness = {roughness:?}, sampling = '{kind}' }} }}"
            );
            mean_weight(&material(&text), 0.8, 200_000, 33)
        };
        let ((a, error_a), (b, error_b)) = (of("cosine"), of("vndf"));
        let z = (a - b) / libm::hypot(error_a, error_b);
        assert!(z.abs() < critical_value(LEVEL / 2.0).unwrap(), "roughness {roughness}: {a} and {b}, {z} errors");
        assert!(error_a > least * error_b, "roughness {roughness}: errors {error_a} and {error_b}");
    }
}
