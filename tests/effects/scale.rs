//! S41: a scene in which every length is multiplied by a power of two is the same scene, to the bit: nothing in lights, fog or lenses
//! depends on the unit of length.

use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use pathmark::scene::{Scene, load};
use std::sync::Arc;

fn checksum(scene: Scene, estimator: &str) -> String {
    let spec = Spec { width: 32, height: 24, seed: 9, estimator: estimator.into(), ..Spec::default() };
    let settings = Settings { spp: 4, spec, threads: 1, ..Settings::default() };
    Setup::for_scene(Arc::new(scene), settings).unwrap().run(None).unwrap().checksum.unwrap()
}

#[test]
fn powers_of_two_change_no_bit() {
    for name in ["report-c", "report-d", "cornell-fog", "cornell-lens"] {
        let scene = load(name).unwrap();
        for estimator in ["bsdf", "whitted"] {
            let expected = checksum(scene.clone(), estimator);
            for exponent in [20, -20] {
                let factor = libm::ldexp(1.0, exponent);
                let found = checksum(scene.scaled(factor), estimator);
                assert_eq!(found, expected, "{name}, {estimator}, 2^{exponent}");
            }
            // The checksum would notice.
            assert_ne!(checksum(scene.scaled(3.0), estimator), expected, "{name}, {estimator}");
        }
    }
}
