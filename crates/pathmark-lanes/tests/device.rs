//! The device kernel returns the same bits as the scalar kernel, sample by sample, on every available device: the
//! host's C compiler, which a machine that builds Rust has, and every device that drivers show. The scalar kernel is
//! the oracle.

use pathmark_lanes::kernel::{Counts, Kernel, Spec, build, choose, devices};
use pathmark_tracer::estimator::ESTIMATORS;
use pathmark_tracer::film::{Bounds, Piece, TileBuffer};
use pathmark_tracer::scene::{PROFILES, SCENES, Scene, load};
use std::collections::BTreeSet;
use std::slice::from_ref;
use std::sync::Arc;

const SAMPLERS: [&str; 4] = ["independent", "hash", "sobol", "stratified"];

const HOST: &str = "device:host";

/// The kernels of all available devices.
fn available() -> Vec<String> {
    let there = devices().into_iter().filter(|listed| listed.is_there);
    there.map(|listed| format!("device:{}", listed.id)).collect()
}

fn render(kernel: &dyn Kernel, piece: &Piece) -> (TileBuffer, Counts) {
    let mut buffer = TileBuffer::new(piece.bounds);
    let counts = kernel.render(piece, &mut buffer);
    assert!(kernel.failure().is_none(), "{:?}", kernel.failure());
    (buffer, counts)
}

/// Asserts that a device renders pieces exactly as the scalar kernel does, with the same counts of ray tests. In single
/// precision the oracle is the kernel `lanes`. Its counts of box and primitive tests are not compared, because it tests
/// rays against more of them at a time. Returns `false` if the device does not render them.
fn is_same(scene: &Arc<Scene>, spec: &Spec, device: &str, pieces: &[Piece]) -> bool {
    // Drivers take seconds to compile a program, C compilers less: the host may have a program per profile, other
    // devices have one for all.
    let effects = if device == HOST { spec.effects.clone() } else { Some("all".to_string()) };
    let on_device = Spec { kernel: device.to_string(), effects, ..spec.clone() };
    if choose(scene, &on_device).unwrap().plan.name() != device {
        return false;
    }
    let is_single = spec.precision == "f32";
    let oracle = if is_single { "lanes" } else { "scalar" };
    let scalar = build(scene, &Spec { kernel: oracle.into(), effects: None, ..spec.clone() }).unwrap();
    let comparable =
        |counts: Counts| if is_single { Counts { box_tests: 0, primitive_tests: 0, ..counts } } else { counts };
    let kernel = build(scene, &on_device).unwrap();
    for piece in pieces {
        let Spec { estimator, sampler, precision, .. } = spec;
        let what = format!("{}, {estimator}, {sampler}, {precision}, {device}: {piece:?}", scene.name);
        let ((expected, counts), (found, on_device)) = (render(&*scalar, piece), render(&*kernel, piece));
        assert_eq!(comparable(on_device), comparable(counts), "{what}");
        assert!(found == expected, "{what}");
    }
    true
}

/// Pieces with arbitrary first and last samples, with one or many parts, some short and some whole.
#[test]
fn devices_add_up_samples_as_a_film_does() {
    let scene = Arc::new(load("cornell").unwrap());
    let spec = Spec { width: 40, height: 30, estimator: "bsdf".into(), sampler: "hash".into(), ..Spec::default() };
    let pieces = [(0..16, 5), (0..1000, 3), (5..782, 2), (16..48, 1), (0..1, 7), (3..20, 4), (0..4100, 1)];
    let pieces =
        pieces.map(|(samples, columns)| Piece { bounds: Bounds { x0: 7, y0: 11, x1: 7 + columns, y1: 13 }, samples });
    for device in available() {
        assert!(is_same(&scene, &spec, &device, &pieces), "{device}");
    }
}

/// Compares every scene with every estimator on a device, in one precision. One scene gets every sampler. The others
/// take turns with the samplers, because random numbers do not depend on the scene. A program for a profile renders that
/// scene and the first one of the profile; all others have the program for every effect, unless the test is thorough.
fn have_the_scalar_kernels_bits(device: &str, precision: &str) {
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 24, y1: 18 }, samples: 0..8 };
    let (mut compared, mut scenes) = (0, 0);
    let (mut profiles, is_thorough) = (BTreeSet::new(), std::env::var_os("PATHMARK_THOROUGH").is_some());
    let mut next = SAMPLERS.into_iter().cycle();
    for (name, _) in SCENES {
        let scene = Arc::new(load(name).unwrap());
        let before = compared;
        let profile = PROFILES.iter().find(|entry| entry.effects.cover(scene.effects())).map(|entry| entry.name);
        let is_first = profiles.insert(profile);
        let effects = (!is_first && !is_thorough && *name != "cornell").then(|| "all".to_string());
        for estimator in ESTIMATORS {
            let samplers = next.by_ref().take(if *name == "cornell" { SAMPLERS.len() } else { 1 });
            for sampler in samplers {
                let (estimator, sampler) = (estimator.name.to_string(), sampler.to_string());
                let spec = Spec { width: 24, height: 18, seed: 3, estimator, sampler, ..Spec::default() };
                let spec = Spec { precision: precision.to_string(), effects: effects.clone(), ..spec };
                compared += usize::from(is_same(&scene, &spec, device, from_ref(&piece)));
            }
        }
        scenes += usize::from(compared > before);
    }
    println!("{device}, {precision}: {compared} comparisons of {scenes} scenes");
    let least = if precision == "f32" { (20, 80) } else { (30, 140) };
    assert!(scenes >= least.0 && compared > least.1, "{compared} comparisons of {scenes} scenes");
}

/// Rays that start outside the box of their own sphere after rounding, in a hierarchy, and scenes that single precision
/// renders in another unit of length.
#[test]
fn extreme_scenes_have_the_same_bits() {
    let text = "about = 'a small ball in a mirror'\nbackground = [0.4, 0.5, 0.6]\n[camera.pinhole]\n\
                position = [0.0, 0.3, 4.0]\nlook-at = [0.0, 0.0, 0.0]\nfield-of-view = 170.0\n[[objects]]\nname = 'ball'\n\
                shape = { sphere = { center = [1.0, -1.0, -3.0], radius = 1e-3 } }\n\
                material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\nemission = [1.0, 1.0, 1.0]\n[[objects]]\n\
                name = 'mirror'\nshape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1e15 } }\n\
                material = { mirror = { albedo = [0.8, 0.8, 0.8] } }\n";
    let mirror = Arc::new(Scene::from_toml(text).unwrap());
    let spec = Spec { width: 64, height: 48, seed: 5, estimator: "bsdf".into(), ..Spec::default() };
    let spec = Spec { accelerator: Some("median".into()), max_depth: Some(12), ..spec };
    let piece = Piece { bounds: Bounds { x0: 29, y0: 21, x1: 39, y1: 33 }, samples: 0..64 };
    let far = Arc::new(load("cornell").unwrap().scaled((1_u64 << 60) as f64));
    let single = Spec { precision: "f32".into(), accelerator: None, max_depth: None, ..spec.clone() };
    for device in available() {
        assert!(is_same(&mirror, &spec, &device, from_ref(&piece)), "{device}");
        assert!(is_same(&far, &single, &device, &[Piece { samples: 0..4, ..piece.clone() }]), "{device}");
    }
}

/// Several camera rays, on a scene with a sky, on one with a lens and on one whose glass splits paths.
#[test]
fn camera_rays_are_those_of_the_scalar_kernel() {
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 24, y1: 18 }, samples: 0..8 };
    let cases = [
        ("nightsky", "mis", "sobol", "f64"),
        ("nightsky", "mis", "sobol", "f32"),
        ("cornell-lens", "bsdf", "hash", "f64"),
        ("cornell", "smallpt", "independent", "f32"),
    ];
    for device in available() {
        for (name, estimator, sampler, precision) in cases {
            let scene = Arc::new(load(name).unwrap());
            let (estimator, sampler, precision) = (estimator.to_string(), sampler.into(), precision.into());
            let spec = Spec { width: 24, height: 18, estimator, sampler, precision, ..Spec::default() };
            let spec = Spec { camera_rays: Some(3), ..spec };
            assert!(is_same(&scene, &spec, &device, from_ref(&piece)), "{device} does not render {name}");
        }
    }
}

#[test]
fn the_host_has_the_scalar_kernels_bits() {
    have_the_scalar_kernels_bits(HOST, "f64");
}

#[test]
fn the_host_has_the_bits_of_lanes_in_single_precision() {
    have_the_scalar_kernels_bits(HOST, "f32");
}

#[test]
fn other_devices_have_the_scalar_kernels_bits() {
    for device in available().iter().filter(|device| *device != HOST) {
        have_the_scalar_kernels_bits(device, "f64");
        have_the_scalar_kernels_bits(device, "f32");
    }
}
