//! The kernel for devices gives what the scalar kernel gives, sample by sample and bit for bit, on every device here: the host's C compiler, which a
//! machine that builds Rust has, and whatever drivers show. The scalar kernel is the oracle.

use pathmark_tracer::estimator::ESTIMATORS;
use pathmark_tracer::film::{Bounds, Piece, TileBuffer};
use pathmark_tracer::kernel::{Counts, Kernel, Spec, build, choose};
use pathmark_tracer::scene::{SCENES, Scene, load};
use std::sync::Arc;

const SAMPLERS: [&str; 5] = ["independent", "hash", "sobol", "sobol-burley", "stratified"];

/// The kernels of all devices here.
fn devices() -> Vec<String> {
    let there = pathmark_device::list().into_iter().filter(|listed| listed.is_there);
    there.map(|listed| format!("device:{}", listed.id)).collect()
}

fn render(kernel: &dyn Kernel, piece: &Piece) -> (TileBuffer, Counts) {
    let mut buffer = TileBuffer::new(piece.bounds);
    let counts = kernel.render(piece, &mut buffer);
    assert!(kernel.failure().is_none(), "{:?}", kernel.failure());
    (buffer, counts)
}

/// Insists that a device renders pieces as the scalar kernel does, what rays are tested against included; `false` if none renders them.
fn is_same(scene: &Arc<Scene>, spec: &Spec, device: &str, pieces: &[Piece]) -> bool {
    let on_device = Spec { kernel: device.to_string(), ..spec.clone() };
    if choose(scene, &on_device).unwrap().kernel() != device {
        return false;
    }
    let scalar = build(scene, &Spec { kernel: "scalar".into(), ..spec.clone() }).unwrap();
    let kernel = build(scene, &on_device).unwrap();
    for piece in pieces {
        let what = format!("{}, {}, {}, {device}: {piece:?}", scene.name, spec.estimator, spec.sampler);
        let ((expected, counts), (found, on_device)) = (render(&*scalar, piece), render(&*kernel, piece));
        assert_eq!(on_device, counts, "{what}");
        assert!(found == expected, "{what}");
    }
    true
}

#[test]
fn every_scene_has_the_scalar_kernels_bits() {
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 24, y1: 18 }, samples: 0..8 };
    for device in devices() {
        let (mut compared, mut scenes) = (0, 0);
        for (name, _) in SCENES {
            let scene = Arc::new(load(name).unwrap());
            let before = compared;
            for estimator in ESTIMATORS {
                for sampler in SAMPLERS {
                    let (estimator, sampler) = (estimator.name.to_string(), sampler.to_string());
                    let spec = Spec { width: 24, height: 18, seed: 3, estimator, sampler, ..Spec::default() };
                    compared += usize::from(is_same(&scene, &spec, &device, std::slice::from_ref(&piece)));
                }
            }
            scenes += usize::from(compared > before);
        }
        assert!(scenes >= 24, "{compared} comparisons of {scenes} scenes on {device}");
    }
}
