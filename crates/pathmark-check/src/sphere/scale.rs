//! Independence of the unit of length: a scene with all lengths multiplied by a power of two gives the same image, to
//! the bit.

use crate::Trials;
use crate::estimator::ESTIMATORS;
use crate::kernel::Spec;
use crate::math::Rgb;
use crate::rendering::{by_kernel, try_render};
use crate::scene::{ACCELERATORS, SCENES, Scene, load};
use std::sync::Arc;

/// Pixels and samples of a comparison.
const SIZE: (u32, u32) = (16, 12);
const SPP: u32 = 4;

/// `count` exponents, evenly from -40 to 40, without 0.
fn exponents(count: i32) -> Vec<i32> {
    (0..count).map(|k| -40 + 80 * k / (count - 1)).filter(|exponent| *exponent != 0).collect()
}

pub(super) fn powers_of_two(trials: &mut Trials) {
    let (few, many) = (trials.times(2, 81) as i32, trials.times(21, 81) as i32);
    let spec = Spec { width: SIZE.0, height: SIZE.1, seed: 7, ..Spec::default() };
    for (name, _) in SCENES {
        let scene = Arc::new(load(name).expect("a shipped scene"));
        for estimator in ESTIMATORS {
            let count = match *name {
                // The most used scene.
                "cornell" => many,
                _ if is_large(&scene) => 2,
                _ => few,
            };
            let spec = Spec { estimator: estimator.name.into(), ..spec.clone() };
            same_bits(trials, &scene, &spec, &exponents(count));
        }
    }
    // Triangles through every hierarchy, whose boxes have a proportional padding. Not in equilibrium, where every
    // pixel would be 1.
    let mut furnace = load("furnace:0.6").expect("a shipped scene");
    for (index, object) in furnace.objects.iter_mut().enumerate() {
        object.emission = if index % 3 == 0 { Rgb::WHITE } else { Rgb::BLACK };
    }
    let furnace = Arc::new(furnace);
    for accelerator in ACCELERATORS {
        let accelerator = Some(accelerator.name.to_string());
        let spec = Spec { estimator: "bsdf".into(), accelerator, ..spec.clone() };
        same_bits(trials, &furnace, &spec, &exponents(few));
    }
}

/// Whether building its accelerator takes long.
fn is_large(scene: &Scene) -> bool {
    scene.owners.len() > 1000
}

/// Renders the scene at each scale. Checksum and counts must equal those at scale 1.
fn same_bits(trials: &mut Trials, scene: &Arc<Scene>, spec: &Spec, exponents: &[i32]) {
    for spec in by_kernel(spec) {
        let image = |trials: &mut Trials, factor: f64| {
            let scaled = Arc::new(scene.scaled(factor));
            try_render(trials, &scaled, spec.clone(), SPP).map(|outcome| (outcome.checksum, outcome.counts))
        };
        let Some(expected) = image(trials, 1.0) else { continue };
        let mut differing = Vec::new();
        for exponent in exponents {
            let found = image(trials, libm::exp2(f64::from(*exponent)));
            if found.as_ref() != Some(&expected) {
                differing.push(format!("2^{exponent}"));
            }
        }
        let search = spec.accelerator.as_ref().map_or_else(String::new, |name| format!(", accelerator {name}"));
        let variant = format!("{}, {}, {}{search}", scene.name, spec.estimator, spec.kernel);
        let found = if differing.is_empty() { "the same".to_string() } else { differing.join(" ") };
        trials.holds(variant, format_args!("the same bits at {} scales", exponents.len()), found, differing.is_empty());
    }
}
