//! Fresnel's formula and Schlick's approximation of it: H10, H11 and H12 of the catalogue of hard cases. Values come from mpmath
//! (`tests/data/fresnel-oracle.json`) and from the diffuse reflectances that the literature knows.

use pathmark::math::{fresnel_dielectric, fresnel_schlick};
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};

const N: f64 = 1.5;

/// From outside and from inside, every hundredth of a cosine.
#[test]
fn exact_values() {
    let text = include_str!("data/fresnel-oracle.json");
    let rows: Vec<[String; 3]> = serde_json::from_str(text).unwrap();
    assert_eq!(rows.len(), 202);
    for [eta, cos, expected] in rows {
        let cos: f64 = cos.parse().unwrap();
        let eta = if eta == "1/1.5" { 1.0 / N } else { eta.parse().unwrap() };
        let expected: f64 = expected.parse().unwrap();
        let found = fresnel_dielectric(cos, eta);
        // From inside the value turns with the square root of the distance to the critical cosine, 0.7454: 0.75 is 20 times that steep.
        assert!((found - expected).abs() <= 2e-15, "eta {eta}, cos {cos}: {found}, not {expected}");
    }
    assert!((fresnel_dielectric(1.0, 12.85) - (11.85_f64 / 13.85) * (11.85 / 13.85)).abs() < 1e-15);
}

/// H10: continuous at the critical angle, and k roundings of the cosine away 1 - R is what it should be within 4e-7 sqrt(k).
#[test]
fn next_to_the_critical_angle() {
    let critical = 5f64.sqrt() / 3.0;
    for (k, expected) in [(1.0, 1.12e-7), (2.0, 1.59e-7), (10.0, 3.55e-7), (1000.0, 3.55e-6)] {
        let step = k * 0.5 * f64::EPSILON;
        let rest = 1.0 - fresnel_dielectric(critical + step, 1.0 / N);
        assert!((rest - expected).abs() <= 4e-7 * f64::sqrt(k), "{k} roundings above: {rest}, not {expected}");
        assert!(fresnel_dielectric(critical - step, 1.0 / N) >= 1.0 - 4e-7 * f64::sqrt(k));
    }
    assert_eq!(fresnel_dielectric(0.7, 1.0 / N), 1.0, "total internal reflection");
}

/// H11, H12: equal indices reflect nothing at all, nearly equal ones next to nothing, and no cosine leads out of [0, 1].
#[test]
fn degenerate_indices_and_cosines() {
    let above = 1.0 + f64::EPSILON;
    for cos in [0.0, -0.0, 1e-150, 1e-8, 0.3, 1.0, above, -above] {
        assert_eq!(fresnel_dielectric(cos, 1.0), 0.0, "cos {cos}");
        for eta in [N, 1.0 / N, 12.85, 1.0 / 12.85, 0.01, 100.0, above, 1.0 - f64::EPSILON] {
            let found = fresnel_dielectric(cos, eta);
            assert!((0.0..=1.0).contains(&found), "cos {cos}, eta {eta}: {found}");
        }
        // The reflectance of a step of a rounding is about (step/4 cos²)².
        if cos.abs() > 0.1 {
            assert!(fresnel_dielectric(cos, above) < 1e-29, "{}", fresnel_dielectric(cos, above));
        }
    }
}

/// The mean over the hemisphere, weighted by the cosine, from a fine midpoint rule in the root of the cosine.
fn diffuse(eta: f64) -> f64 {
    let n = 1 << 20;
    let mean = |k: u32| {
        let cos = (f64::from(k) + 0.5) / f64::from(n);
        2.0 * cos * fresnel_dielectric(cos, eta)
    };
    (0..n).map(mean).sum::<f64>() / f64::from(n)
}

/// The diffuse reflectances of n = 1.5 from either side, and 1 - r(inside) = (1 - r(outside))/n², which ties them together.
#[test]
fn diffuse_reflectances() {
    let (outside, inside) = (diffuse(N), diffuse(1.0 / N));
    assert!((outside - 0.091_777_959_342_351_21).abs() < 1e-9, "{outside}");
    // The infinite slope at the critical angle costs the rule some digits.
    assert!((inside - 0.596_345_759_707_711_6).abs() < 1e-8, "{inside}");
    assert!((1.0 - inside - (1.0 - outside) / (N * N)).abs() < 1e-8);
}

/// What the documentation says of Schlick's approximation: at most 0.0357 off, at cosine 0.088 from outside and 0.7476 from inside
/// (a search in Python by the form of Fresnel's own sines and tangents).
#[test]
fn schlick_is_as_far_off_as_documented() {
    let worst = |error: &dyn Fn(f64) -> f64| {
        let all = (0..=100_000).map(|k| f64::from(k) / 100_000.0).map(|cos| (error(cos), cos));
        all.fold((0.0, 0.0), |worst, this| if this.0 > worst.0 { this } else { worst })
    };
    let (error, cos) = worst(&|cos| (fresnel_schlick(cos, 0.04) - fresnel_dielectric(cos, N)).abs());
    assert!((error - 0.035_692_2).abs() < 1e-6 && (cos - 0.088).abs() < 1e-3, "{error} at {cos}");
    let (error, cos) = worst(&|cos| {
        let outside2 = 1.0 - N * N * (1.0 - cos * cos);
        if outside2 < 0.0 {
            return 0.0;
        }
        (fresnel_schlick(outside2.sqrt(), 0.04) - fresnel_dielectric(cos, 1.0 / N)).abs()
    });
    assert!((error - 0.035_692_6).abs() < 1e-6 && (cos - 0.7476).abs() < 1e-3, "{error} at {cos}");
}

/// What enters at one angle leaves at the refracted one: the share is the same from both sides.
#[test]
fn the_same_share_from_both_sides() {
    for sample in 0..100_000 {
        let key = SampleKey { seed: 11, pixel: 0, sample };
        let [u, v] = Independent.pair(Address { key, bounce: 0, branch: 0, purpose: Purpose::Bsdf });
        let (cos, eta) = (u, 1.0 + 2.0 * v);
        let beyond = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
        let (there, back) = (fresnel_dielectric(cos, eta), fresnel_dielectric(beyond, 1.0 / eta));
        // `beyond` is rounded, which steep angles magnify: d(cos)/d(beyond) = eta² beyond/cos.
        assert!((there - back).abs() < 1e-14 + 1e-14 / cos, "eta {eta}, cos {cos}: {there} and {back}");
    }
}
