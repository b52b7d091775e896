//! Coincident and nearly coincident spheres.

use crate::bare_scene::{intersect, scene_of_spheres, searches};
use crate::math::{Ray, Vec3};
use crate::random::Random;
use crate::scene::{Scene, Sphere};
use crate::{Case, Trials};

pub(super) const CASES: &[Case] = &[Case {
    id: "S48",
    tries: "shells 2^-40 apart and identical spheres: the nearest, then the lowest number",
    run: nearest_then_lowest,
}];

fn nearest_then_lowest(trials: &mut Trials) {
    let concentric = |radii: &[f64]| {
        let sphere = |radius: &f64| Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: *radius };
        scene_of_spheres(radii.iter().map(sphere).collect())
    };
    let thin = concentric(&[1.0, 1.0 + libm::exp2(-40.0)]);
    let identical = concentric(&[0.5, 1.0, 1.0, 1.0]);
    let rays = trials.times(1000, 1_000_000);
    for (what, scene, from_outside, from_inside) in [("thin shell", thin, 1, 0), ("identical", identical, 1, 1)] {
        for (name, scene) in searches(&scene) {
            let mut random = Random::new(48);
            let seen = |scene: &Scene, ray: &Ray| intersect(scene, ray, None).map(|hit| hit.primitive);
            let wrong = (0..rays).filter(|_| {
                let out = random.direction();
                let inwards = Ray { origin: out * 3.0, direction: -out };
                let outwards = Ray { origin: out * 0.9, direction: out };
                (seen(&scene, &inwards), seen(&scene, &outwards)) != (Some(from_outside), Some(from_inside))
            });
            let wrong = wrong.count() as u64;
            trials.never(format!("{what}, accelerator {name}"), "another sphere than the first", wrong, rays);
        }
    }
}
