//! Long and branched paths on a small stack: 128 KiB are enough, where Rust's default is 2 MiB.

use crate::estimate::{object, scene, sphere, view};
use pathmark::film::{Bounds, Piece, TileBuffer};
use pathmark::kernel::{self, Counts, Spec};
use pathmark::scene::{Scene, load};
use std::sync::Arc;
use std::thread;

const STACK: usize = 128 << 10;
const SPP: u32 = 5000;

/// The counts of one pixel, rendered in a thread with a small stack.
fn pixel(scene: Scene, estimator: &str) -> Counts {
    let spec = Spec { width: 1, height: 1, estimator: estimator.into(), ..Spec::default() };
    let kernel = kernel::build(&Arc::new(scene), &spec).unwrap();
    let render = move || {
        let bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };
        let mut buffer = TileBuffer::new(bounds);
        kernel.render(&Piece { bounds, samples: 0..SPP }, &mut buffer)
    };
    thread::Builder::new().stack_size(STACK).spawn(render).unwrap().join().unwrap()
}

/// A scene of mirrors only, whose paths only roulette ends, and a closed box that loses a thousandth at each bounce.
#[test]
fn long_paths() {
    for estimator in ["smallpt", "bsdf"] {
        for (name, rays) in [("wada2", 4), ("furnace:0.999", 300)] {
            let counts = pixel(load(name).unwrap(), estimator);
            assert_eq!((counts.paths, counts.invalid, counts.escaped), (u64::from(SPP), 0, 0), "{name}, {estimator}");
            assert!(counts.rays > rays * counts.paths, "{name}, {estimator}: {} rays are no long paths", counts.rays);
        }
    }
}

/// Nested glass, with all branches followed.
#[test]
fn branched_paths() {
    let glass = |eta: f64| format!("{{ dielectric = {{ eta = {eta:?}, tint = [1.0, 1.0, 1.0] }} }}");
    let background = "background = [1.0, 1.0, 1.0]\n".to_string();
    let balls = [(2.0, 1.5), (1.2, 0.8), (0.5, 2.0)]
        .map(|(radius, eta)| object(&sphere([0.1 * radius, 0.0, 0.0], radius), &glass(eta), [0.0; 3]));
    let camera = view([0.0, 0.3, 6.0], [0.0, 0.2, 0.0], [0.0, 1.0, 0.0], 5.0);
    let scene = scene(&[vec![background, camera], balls.to_vec()].concat());
    let counts = pixel(scene, "whitted");
    assert_eq!((counts.paths, counts.invalid), (u64::from(SPP), 0));
    assert!(counts.truncated > 0 && counts.rays > 30 * counts.paths, "{} rays are no tree", counts.rays);
}
