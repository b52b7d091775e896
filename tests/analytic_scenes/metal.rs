//! Rough metal under an even sky.

use super::unsplit_estimators;
use crate::estimate::{assert_exact, camera, object, plane, render, scene};

/// What a rough surface of F = 1 leaves of an even radiance of 1, by roughness and cosine of the view: single scattering by GGX with
/// height-correlated shadowing, computed to 1e-6 by quadrature; 1 - ln 2 in the last row at normal incidence.
const ALBEDO: [(f64, [(f64, f64); 3]); 4] = [
    (0.05, [(1.0, 0.997_296), (0.5, 0.992_716), (0.1, 0.911_347)]),
    (0.25, [(1.0, 0.915_812), (0.5, 0.857_263), (0.1, 0.891_622)]),
    (0.5, [(1.0, 0.687_849), (0.5, 0.698_251), (0.1, 0.860_105)]),
    (1.0, [(1.0, 0.306_852_819_440_054_7), (0.5, 0.450_694), (0.1, 0.760_211)]),
];

/// A21: a plane of metal seen under an angle.
#[test]
fn metal_under_a_sky() {
    let tests = 12 * unsplit_estimators().count();
    for (alpha, row) in ALBEDO {
        let metal = format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 1.0, 1.0] }} }}");
        // The darker, the more it takes to see 0.3 %.
        let samples = if alpha < 1.0 { 1_000_000 } else { 3_000_000 };
        for (cos, exact) in row {
            let sin = f64::sqrt(1.0 - cos * cos);
            let scene = scene(&[
                "background = [1.0, 1.0, 1.0]\n".to_string(),
                camera([10.0 * sin, 10.0 * cos, 0.0], [0.0; 3]),
                object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &metal, [0.0; 3]),
            ]);
            for estimator in unsplit_estimators() {
                let outcome = render(&scene, estimator, samples, None);
                assert_exact(&format!("alpha {alpha}, cos {cos}, {estimator}"), &outcome, 0, exact, tests);
            }
        }
    }
}
