//! H22: GGX's density of normals and its masking are right to 20 roundings at every roughness, against double-double arithmetic on the same inputs. The form with
//! 1 + cos²(α² - 1), which loses its digits, would not pass.

#[path = "../src/check/double_double.rs"]
mod double_double;

use double_double::two_product;
use pathmark::material::Ggx;
use pathmark::math::{Vec3, sin_cos_turns};
use std::f64::consts::PI;

const ALPHAS: [f64; 9] = [1e-4, 3e-4, 1e-3, 0.01, 0.05, 0.1, 0.25, 0.5, 1.0];

/// α²/(π (x² + y² + α² z²)²), which is D with its fraction cleared.
fn exact(alpha: f64, h: Vec3) -> f64 {
    let alpha2 = two_product(alpha, alpha);
    let sum = two_product(h.x, h.x) + two_product(h.y, h.y) + alpha2 * two_product(h.z, h.z);
    alpha2.over(sum * sum * two_product(PI, 1.0))
}

/// G1 = 2z/(z + sqrt(z² + α²(x² + y²))).
fn exact_masking(alpha: f64, w: Vec3) -> f64 {
    let z = two_product(w.z, 1.0);
    let flat = two_product(w.x, w.x) + two_product(w.y, w.y);
    (z + z).over(z + (z * z + two_product(alpha, alpha) * flat).sqrt())
}

#[test]
fn twenty_roundings() {
    let (mut worst, mut cancelling): (f64, f64) = (0.0, 0.0);
    for alpha in ALPHAS {
        let ggx = Ggx::new(alpha).unwrap();
        for k in 0..20_000 {
            // From the middle of the lobe, evenly in its logarithm, to beyond its edge; the last ones along the surface.
            let tan = if k == 0 { 0.0 } else { alpha * libm::exp2(f64::from(k) / 500.0 - 20.0) };
            let (sin, cos) = sin_cos_turns(f64::from(k % 97) / 97.0);
            let h = Vec3::new(tan * cos, tan * sin, 1.0).normalized();
            let right = exact(alpha, h);
            let error = |found: f64| (found / right - 1.0).abs() / (0.5 * f64::EPSILON);
            worst = worst.max(error(ggx.density(h)));
            let masking = (ggx.masking(h) / exact_masking(alpha, h) - 1.0).abs() / (0.5 * f64::EPSILON);
            worst = worst.max(masking);
            let divisor = 1.0 + h.z * h.z * (alpha * alpha - 1.0);
            cancelling = cancelling.max(error(alpha * alpha / (PI * divisor * divisor)));
        }
    }
    assert!(worst <= 20.0, "{worst} roundings");
    assert!(
        cancelling > 1e6,
        "the usual form is off by {cancelling} roundings: these inputs would not tell the two apart"
    );
}
