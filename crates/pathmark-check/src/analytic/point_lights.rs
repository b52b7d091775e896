//! Point lights over a plane, where nothing is random, by every estimator.

use crate::exact::{Bench, every_estimator};
use crate::stage::{camera, diffuse, object, plane, point_light, scene, sphere};
use crate::{Case, Trials};
use std::f64::consts::{FRAC_1_PI, PI};

pub(super) const CASES: &[Case] =
    &[Case { id: "A7", tries: "point lights over a plane: rho I cos/(pi d^2)", run: light_over_a_plane }];

fn light_over_a_plane(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    let floor = object(&plane([0.0; 3], [0.0, 1.0, 0.0]), &diffuse(0.5), [0.0; 3]);
    for (x, exact) in [(0.0, 0.159_154_943_091_895_34), (1.0, 0.056_269_769_759_819_14)] {
        let at = camera([0.0, 3.0, 1.0], [x, 0.0, 0.0]);
        let scene = scene(&[at, point_light([0.0, 1.0, 0.0], 1.0), floor.clone()]);
        bench.each(&format!("x {x}"), &scene, every_estimator(), &[exact]);
    }
    // Doubling the distance leaves a quarter of the light, from near to far.
    for height in [0.25, 0.5, 8.0, 512.0] {
        let at = camera([0.0, 0.1, 0.1], [0.0; 3]);
        let scene = scene(&[at, point_light([0.0, height, 0.0], 1.0), floor.clone()]);
        let exact = 0.5 * FRAC_1_PI / (height * height);
        bench.each(&format!("height {height}"), &scene, every_estimator(), &[exact]);
    }
    // Lights add up, each is occluded separately, and a light below the floor does not light its upper side.
    let parts = [
        camera([0.0, 0.5, 0.5], [0.0; 3]),
        point_light([0.0, 1.0, 0.0], 1.0),
        point_light([0.0, 2.0, 0.0], 2.0),
        point_light([2.0, 2.0, 0.0], 1000.0), // behind the ball
        point_light([0.0, -1.0, 0.0], 1000.0),
        floor,
        object(&sphere([1.0, 1.0, 0.0], 0.25), &diffuse(0.0), [0.0; 3]),
    ];
    bench.each("several", &scene(&parts), every_estimator(), &[0.5 / PI * (1.0 + 2.0 / 4.0)]);
}
