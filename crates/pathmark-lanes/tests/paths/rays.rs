//! Ray search apart from paths.

use pathmark_lanes::kernel::{FoundRays, RaySearch, Spec, choose, path_rays};
use pathmark_tracer::scene::load;
use std::sync::Arc;

fn search(scene: &str, kernel: &str, precision: &str) -> FoundRays {
    let scene = Arc::new(load(scene).unwrap());
    let spec = Spec {
        width: 16,
        height: 12,
        estimator: "bsdf".to_string(),
        kernel: kernel.to_string(),
        precision: precision.to_string(),
        ..Spec::default()
    };
    let choice = choose(&scene, &spec).unwrap();
    let rays = path_rays(&scene, &choice, &(0..2)).unwrap();
    let search = RaySearch::new(&scene, &choice, rays).unwrap();
    assert!(search.count() > 100);
    search.run()
}

/// Every ray has the same hit as its path had, whichever kernel searches.
#[test]
fn rays_of_paths_meet_the_same_primitives() {
    for scene in ["bumpy-ball", "cornell", "spheres:300", "cornell-mesh"] {
        let scalar = search(scene, "scalar", "f64");
        assert_eq!(scalar.met, scalar.counts.rays, "{scene}");
        let lanes = search(scene, "lanes", "f64");
        assert_eq!((lanes.met, lanes.distance.to_bits()), (scalar.met, scalar.distance.to_bits()), "{scene}");
        let singles = search(scene, "lanes", "f32");
        assert!(singles.met.abs_diff(scalar.met) <= 2, "{scene}");
        // About ten rays in a million hit the other side of an edge.
        assert!((singles.distance / scalar.distance - 1.0).abs() < 1e-3, "{scene}");
    }
}
