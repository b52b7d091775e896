//! Determinism: equal settings give equal images (docs/notes/determinism.md, and G10, F12 of the catalogue of hard cases).
//! The recorded checksums are in its table (`crates/pathmark-check/src/path/order.rs`).

use pathmark::film::{Bounds, Piece, PixelSum, TileBuffer};
use pathmark::kernel::{self, Spec};
use pathmark::math::Vec3;
use pathmark::measure::{Outcome, Settings, Setup};
use pathmark::sampling::SAMPLERS;
use pathmark::scene::{Object, Scene, Sphere, Triangle, load};
use std::ops::Range;
use std::sync::Arc;

fn spec(estimator: &str) -> Spec {
    Spec { width: 96, height: 64, seed: 7, estimator: estimator.into(), ..Spec::default() }
}

fn run(scene: &Arc<Scene>, spec: Spec) -> Outcome {
    let (decomposition, strategy) = ("rows".into(), "serial".into());
    let settings = Settings { spp: 8, spec, decomposition, strategy, threads: 1, ..Settings::default() };
    Setup::for_scene(Arc::clone(scene), settings).unwrap().run(None).unwrap()
}

fn checksum(scene: &Scene, spec: Spec) -> String {
    run(&Arc::new(scene.clone()), spec).checksum.unwrap()
}

/// The checksum tells images apart: another seed, estimator or size changes it.
#[test]
fn a_checksum_tells_images_apart() {
    let scene = load("cornell").unwrap();
    let all = [
        spec("smallpt"),
        Spec { seed: 8, ..spec("smallpt") },
        Spec { width: 64, height: 96, ..spec("smallpt") },
        spec("bsdf"),
    ];
    let mut checksums: Vec<String> = all.into_iter().map(|spec| checksum(&scene, spec)).collect();
    checksums.sort();
    checksums.dedup();
    assert_eq!(checksums.len(), 4);
}

/// Random numbers belong to addresses, so an object that no ray can reach changes none of them.
#[test]
fn an_unreachable_object_changes_nothing() {
    let cornell = load("cornell").unwrap();
    let mut larger = cornell.clone();
    // Beyond the left wall, whose sphere encloses the box.
    larger.primitives.spheres.push(Sphere { center: [-500.0, 40.0, 80.0].into(), radius: 30.0 });
    larger.objects.push(Object { name: "unreachable".into(), ..cornell.objects[0].clone() });
    larger.owners.push(cornell.objects.len() as u32);
    for estimator in ["smallpt", "bsdf"] {
        assert_eq!(checksum(&larger, spec(estimator)), checksum(&cornell, spec(estimator)), "{estimator}");
    }
    // The same holds with a hierarchy, and for a triangle.
    let mut another = larger.clone();
    let corners = [[-500.0, 0.0, 0.0], [-500.0, 90.0, 0.0], [-500.0, 0.0, 90.0]].map(Vec3::from);
    another.primitives.triangles.push(Triangle { corners });
    another.owners.push(cornell.objects.len() as u32);
    for accelerator in ["none", "median", "sah"] {
        let spec = Spec { accelerator: Some(accelerator.into()), ..spec("bsdf") };
        assert_eq!(checksum(&another, spec.clone()), checksum(&cornell, spec), "{accelerator}");
    }
    // The checksum does change if the object can be reached.
    larger.primitives.spheres.last_mut().unwrap().center = [50.0, 30.0, 60.0].into();
    assert_ne!(checksum(&larger, spec("bsdf")), checksum(&cornell, spec("bsdf")));
}

/// A sample is a function of its index, with every sampler. The first 16 of 32 samples are the 16-sample image. Both
/// halves add up to the whole, to the bit. A window of the film equals that window of the whole.
#[test]
fn parts_are_parts_of_the_whole() {
    let scene = Arc::new(load("cornell").unwrap());
    for sampler in SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name) {
        let kernel = kernel::build(&scene, &Spec { sampler: sampler.into(), ..spec("smallpt") }).unwrap();
        let render = |samples: Range<u32>, bounds: Bounds| -> Vec<PixelSum> {
            let mut buffer = TileBuffer::new(bounds);
            kernel.render(&Piece { bounds, samples }, &mut buffer);
            buffer.rows().flatten().copied().collect()
        };
        let film = Bounds { x0: 0, y0: 0, x1: 96, y1: 64 };
        let (whole, first, second) = (render(0..32, film), render(0..16, film), render(16..32, film));
        for ((whole, first), second) in whole.iter().zip(&first).zip(&second) {
            assert_eq!(*whole, first.plus(second), "{sampler}");
        }
        let window = Bounds { x0: 11, y0: 7, x1: 40, y1: 30 };
        let columns = window.x0 as usize..window.x1 as usize;
        let cut: Vec<PixelSum> =
            first.chunks_exact(96).take(30).skip(7).flat_map(|row| &row[columns.clone()]).copied().collect();
        assert_eq!(render(0..16, window), cut, "{sampler}");
    }
}
