//! Rough metal under a uniform sky.

use crate::exact::{Bench, unsplit_estimators};
use crate::stage::{camera, object, plane, scene};
use crate::{Case, Trials};

pub(super) const CASES: &[Case] = &[Case { id: "A21", tries: "rough metal under an even sky", run: metal_under_a_sky }];

/// Cosines of the viewing angle.
const COSINES: [f64; 6] = [1.0, 0.75, 0.5, 0.25, 0.1, 0.05];

/// Albedo of a rough surface with F = 1, by roughness: single scattering by GGX with height-correlated shadowing,
/// computed to 1e-6 by quadrature; the last row at normal incidence is 1 - ln 2.
const ALBEDO: [(f64, [f64; 6]); 7] = [
    (0.01, [0.999_899, 0.999_858, 0.999_742, 0.999_092, 0.994_124, 0.976_208]),
    (0.05, [0.997_296, 0.996_138, 0.992_716, 0.974_512, 0.911_347, 0.889_894]),
    (0.1, [0.988_304, 0.983_144, 0.969_205, 0.921_623, 0.883_455, 0.911_763]),
    (0.25, [0.915_812, 0.891_533, 0.857_263, 0.840_082, 0.891_622, 0.933_132]),
    (0.5, [0.687_849, 0.682_083, 0.698_251, 0.765_203, 0.860_105, 0.912_548]),
    (0.75, [0.463_917, 0.501_411, 0.564_623, 0.680_248, 0.810_714, 0.880_610]),
    (1.0, [0.306_852_819_440_054_7, 0.364_527, 0.450_694, 0.597_641, 0.760_211, 0.847_774]),
];

/// A metal plane, seen at several angles.
fn metal_under_a_sky(trials: &mut Trials) {
    let fewest = trials.times(8192, 10_000_000) as f64;
    let mut bench = Bench::new(trials);
    bench.fewest = fewest;
    for (alpha, row) in ALBEDO {
        // Smooth metal loses only the few reflections that leave below the horizon.
        bench.rare = alpha < 0.1;
        let metal = format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 1.0, 1.0] }} }}");
        for (cos, exact) in COSINES.into_iter().zip(row) {
            let sin = f64::sqrt(1.0 - cos * cos);
            let scene = scene(&[
                "background = [1.0, 1.0, 1.0]\n".to_string(),
                camera([10.0 * sin, 10.0 * cos, 0.0], [0.0; 3]),
                object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &metal, [0.0; 3]),
            ]);
            bench.each(&format!("alpha {alpha}, cos {cos}"), &scene, unsplit_estimators(), &[exact]);
        }
    }
}
