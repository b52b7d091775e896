//! Endless paths.

use pathmark::estimator::{ESTIMATORS, MAX_BOUNCES};
use pathmark::kernel::{KERNELS, Spec};
use pathmark::measure::{Settings, Setup};
use std::fs;

/// P01, P03 in fog: if it scatters everything and absorbs nothing, a path reaches the maximum number of vertices, is
/// cut there, and is counted.
#[test]
fn paths_in_endless_fog_are_cut_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("fog.toml");
    let text = "about = 'a ball far away in fog'\n\n[fog]\nabsorption = [0.0, 0.0, 0.0]\nscattering = 1e9\n\n[camera.pinhole]\n\
                position = [0.0, 0.0, 5.0]\nlook-at = [0.0, 0.0, 0.0]\nfield-of-view = 40.0\n\n[[objects]]\nname = 'ball'\n\
                shape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }\n\
                material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\nemission = [1.0, 1.0, 1.0]\n";
    fs::write(&scene, text).unwrap();
    for (entry, kernel) in ESTIMATORS.iter().flat_map(|entry| KERNELS.iter().map(move |kernel| (entry, kernel))) {
        let (estimator, kernel) = (entry.name.to_string(), kernel.name.to_string());
        let spec = Spec { width: 1, height: 1, estimator, kernel, ..Spec::default() };
        let settings = Settings { scene: scene.to_str().unwrap().into(), spp: 4, spec, ..Settings::default() };
        let Ok(setup) = Setup::prepare(settings) else { continue };
        let counts = setup.run(None).unwrap().counts;
        assert_eq!((counts.paths, counts.invalid), (4, 0), "{}", entry.name);
        // Whitted's rays go straight through fog.
        if counts.rays > 4 * u64::from(u8::MAX) {
            assert_eq!(counts.truncated, 4, "{}", entry.name);
            assert!(counts.rays >= 4 * (u64::from(MAX_BOUNCES) + 1), "{}: {} rays", entry.name, counts.rays);
        } else {
            assert_eq!(entry.name, "whitted");
        }
    }
}
