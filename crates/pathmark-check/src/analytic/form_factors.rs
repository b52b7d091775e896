//! Form factors: the share of one surface's light that arrives at another, measured as the mean over a surface that
//! the camera samples evenly.

use crate::Trials;
use crate::exact::{Bench, aiming_estimators, unsplit_estimators};
use crate::stage::{diffuse, object, quad, scene, view};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Corners of the polygon that approximates a disk.
const CORNERS: u32 = 64;

/// A disk at a height, as triangles of the same area. The error of the shape is of order 1/`CORNERS`^2 and averages
/// out.
fn disk(height: f64, radius: f64, material: &str, emission: f64) -> String {
    let step = TAU / f64::from(CORNERS);
    let rim = radius * (PI / (f64::from(CORNERS) * 0.5 * libm::sin(step))).sqrt();
    let corner = |k: u32| {
        let angle = step * f64::from(k % CORNERS);
        [rim * libm::cos(angle), height, rim * libm::sin(angle)]
    };
    let triangle = |k| {
        let corners = [[0.0, height, 0.0], corner(k), corner(k + 1)];
        object(&format!("{{ triangle = {{ corners = {corners:?} }} }}"), material, [emission; 3])
    };
    (0..CORNERS).map(triangle).collect()
}

/// (S - sqrt(S^2 - 4 (r2/r1)^2))/2 with S = 1 + (1 + (r2/h)^2)/(r1/h)^2: the share of one disk's light that arrives at
/// another. The lower disk is white and has radius 1. The camera looks straight down at the square around it, of which
/// the disk covers pi/4.
pub(super) fn coaxial_disks(trials: &mut Trials) {
    let mut bench = Bench::new(trials);
    bench.by_pixel = false;
    for (radius, height, exact, by_chance) in [
        (1.0, 1.0, 0.381_966_011_250_105_15, [5e-2, 3e-3]),
        (2.0, 1.0, 0.763_932_022_500_210_3, [3e-2, 2e-3]),
        (1.0, 10.0, 0.009_804_864_072_151_717, [2e-1, 2e-2]),
    ] {
        let scene = scene(&[
            "background = [0.0, 0.0, 0.0]\n".to_string(),
            view([0.0, 0.5, 0.0], [0.0; 3], [0.0, 0.0, 1.0], 2.0 * libm::atan(2.1).to_degrees()),
            disk(0.0, 1.0, &diffuse(1.0), 0.0),
            disk(height, radius, &diffuse(0.0), 1.0),
        ]);
        // The view is 2.1 wide, so that the corners of the polygon are in it.
        let exact = exact * FRAC_PI_4 / (1.05 * 1.05);
        let what = format!("r2 {radius}, h {height}");
        bench.widest = [1e-2, 1e-3];
        bench.each(&what, &scene, aiming_estimators(), &[exact]);
        bench.widest = by_chance;
        bench.each(&what, &scene, unsplit_estimators().filter(|name| *name == "bsdf"), &[exact]);
    }
}

/// A camera in the centre sees exactly one face, evenly. The face opposite glows red, one beside it green, all of them
/// blue.
pub(super) fn faces_of_a_cube(trials: &mut Trials) {
    let face = |axis: usize, side: f64, material: &str, emission: [f64; 3]| {
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[u, v]| {
            let mut corner = [side; 3];
            (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (u, v);
            corner
        });
        object(&quad(corners), material, emission)
    };
    let black = diffuse(0.0);
    let scene = scene(&[
        view([0.0; 3], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], 90.0),
        face(1, -0.5, &diffuse(1.0), [0.0; 3]),
        face(1, 0.5, &black, [1.0, 0.0, 1.0]),
        face(0, 0.5, &black, [0.0, 1.0, 1.0]),
        face(0, -0.5, &black, [0.0, 0.0, 1.0]),
        face(2, 0.5, &black, [0.0, 0.0, 1.0]),
        face(2, -0.5, &black, [0.0, 0.0, 1.0]),
    ]);
    let mut bench = Bench::new(trials);
    bench.by_pixel = false;
    bench.widest = [2e-2, 1e-3];
    // The corners of the cube are so near to the light that the variance of next-event estimation alone has no bound
    // there.
    let bounded = unsplit_estimators().filter(|name| *name != "nee");
    bench.each("cube", &scene, bounded, &[0.199_824_895_698_387_38, 0.200_043_776_075_403_15, 1.0]);
    bench.trials.skip("nee: next to an edge the samples of what aims alone have no variance");
}
