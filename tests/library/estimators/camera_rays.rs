//! Several camera rays per sample: their light is averaged, with every kernel, and nothing is counted twice or left
//! out.

use crate::lanes::assert_same;
use pathmark::analysis::{chi_square, z_test::critical_value};
use pathmark::estimator::ESTIMATORS;
use pathmark::film::{Bounds, Piece};
use pathmark::kernel::{Spec, build, choose, one_sample};
use pathmark::scene::{AngularEmission, Scene, load};
use pathmark::simd::levels;
use std::sync::Arc;

const LEVEL: f64 = 1e-3;
const SAMPLERS: [&str; 3] = ["independent", "hash", "sobol"];

/// The sky is white, and the ground is black: half of the rays of the only pixel see light.
const HORIZON: &str = r#"
    about = "the horizon halves the image"
    background = [1.0, 1.0, 1.0]
    [camera.pinhole]
    position = [0.0, 1.0, 0.0]
    look-at = [0.0, 1.0, -1.0]
    field-of-view = 40.0
    [[objects]]
    name = "ground"
    shape = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 1.0, 0.0] } }
    material = { diffuse = { albedo = [0.0, 0.0, 0.0] } }
"#;

/// With `rays` camera rays, the light of a sample is binomially distributed with probability one half. So the path's
/// own ray has the same weight as the others, and their random numbers are independent of its own (chi-square tests of
/// 20,000 samples, two-sided, family-wise level 1e-3).
#[test]
fn a_sample_has_the_mean_radiance_of_its_camera_rays() {
    const SAMPLES: u32 = 20_000;
    let scene = Arc::new(Scene::from_toml(HORIZON).unwrap());
    for (sampler, kernel) in [("independent", "scalar"), ("hash", "lanes")] {
        for (rays, weights) in [(1_u16, vec![1.0, 1.0]), (4, vec![1.0, 4.0, 6.0, 4.0, 1.0])] {
            let (estimator, sampler, filter) = ("bsdf".to_string(), sampler.to_string(), Some("box".to_string()));
            let spec = Spec { width: 1, height: 1, seed: 5, estimator, sampler, filter, ..Spec::default() };
            let spec = Spec { camera_rays: Some(rays), kernel: kernel.to_string(), ..spec };
            assert_eq!(choose(&scene, &spec).unwrap().plan.name(), kernel);
            let kernel = build(&scene, &spec).unwrap();
            let mut found = vec![0.0; weights.len()];
            for sample in 0..SAMPLES {
                let ([light, ..], counts) = one_sample(&*kernel, [0, 0], sample);
                assert_eq!(counts.rays, u64::from(rays));
                found[(light * f64::from(rays)).round() as usize] += 1.0;
            }
            let all = f64::from(1 << rays);
            let expected: Vec<f64> = weights.iter().map(|weight| weight / all * f64::from(SAMPLES)).collect();
            let score = chi_square::against(&found, &expected);
            assert!(score.abs() < critical_value(LEVEL / 4.0).unwrap(), "{rays} rays: {found:?}, {score:.2}");
        }
    }
}

/// Scenes of spheres, of triangles, with a sky, and with many primitives in a tree. The number of samples is no
/// multiple of the lanes.
#[test]
fn lanes_have_the_scalar_kernels_bits() {
    let bounds = Bounds { x0: 0, y0: 0, x1: 13, y1: 7 };
    for name in ["cornell", "cornell-mesh", "nightsky", "spheres:300", "sky"] {
        let scene = Arc::new(load(name).unwrap());
        for entry in ESTIMATORS.iter().filter(|entry| entry.shares_camera_rays) {
            for (sampler, rays) in SAMPLERS.into_iter().zip([2, 3, 8, 5]) {
                let (estimator, sampler, camera_rays) = (entry.name.to_string(), sampler.to_string(), Some(rays));
                let spec = Spec { width: 13, height: 7, estimator, sampler, camera_rays, ..Spec::default() };
                let pieces = [0..4, 3..12].map(|samples| Piece { bounds, samples });
                assert_same(&scene, &spec, &pieces);
                let single = |level: &str| {
                    let (precision, simd) = ("f32".to_string(), Some(level.to_string()));
                    let kernel = build(&scene, &Spec { precision, simd, ..spec.clone() }).unwrap();
                    [1, 6].map(|x| one_sample(&*kernel, [x, 5], 3).0)
                };
                let all: Vec<_> = levels().map(|level| single(level.name())).collect();
                assert!(all.iter().all(|sums| *sums == all[0]), "{name}, {}, f32: {all:?}", entry.name);
            }
        }
    }
}

/// All rays through the centre of a pixel are the same ray, so four of them give the light of one: lamps, the sky, the
/// emission of fog and its attenuation of both, and a lamp whose emission depends on the angle. In single precision
/// they agree nearly.
#[test]
fn rays_that_are_one_ray_see_the_same() {
    let lit = r#"
        about = "a lamp in glowing fog"
        background = [0.25, 0.5, 0.75]
        [camera.pinhole]
        position = [0.0, 0.0, 5.0]
        look-at = [0.0, 0.0, 0.0]
        field-of-view = 40.0
        [fog]
        absorption = [0.1, 0.2, 0.3]
        scattering = 0.0
        emission = [3.0, 2.0, 1.0]
        [[objects]]
        name = "lamp"
        shape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }
        material = { diffuse = { albedo = [0.0, 0.0, 0.0] } }
        emission = [5.0, 6.0, 7.0]
    "#;
    let lamp = Scene::from_toml(lit).unwrap();
    let mut spot = lamp.clone();
    spot.objects[0].angular_emission = AngularEmission::tabulate(|cos| Some(lamp.objects[0].emission * cos));
    assert!(spot.objects[0].angular_emission.is_some());
    let shipped = ["cornell", "nightsky", "cornell-mesh"].map(|name| load(name).unwrap());
    for scene in [lamp, spot].into_iter().chain(shipped) {
        let scene = Arc::new(scene);
        for (kernel, precision, tolerance) in [("scalar", "f64", 1e-14), ("lanes", "f32", 1e-6)] {
            let seen = |rays: u16| {
                let (estimator, filter, max_depth) = ("bsdf".to_string(), Some("center".to_string()), Some(0));
                let (kernel, precision) = (kernel.to_string(), precision.to_string());
                let spec = Spec { width: 16, height: 12, estimator, filter, max_depth, ..Spec::default() };
                let kernel = build(&scene, &Spec { kernel, precision, camera_rays: Some(rays), ..spec }).unwrap();
                let lights = (0..16 * 12).map(|pixel| one_sample(&*kernel, [pixel % 16, pixel / 16], 0).0);
                lights.collect::<Vec<_>>()
            };
            let (one, four) = (seen(1), seen(4));
            assert!(one.iter().flatten().any(|light| *light > 0.0), "{}: nothing to see", scene.name);
            for (one, four) in one.iter().flatten().zip(four.iter().flatten()) {
                assert!((four - one).abs() <= tolerance * one, "{}, {precision}: {four} for {one}", scene.name);
            }
        }
    }
}

/// One camera ray is the default.
#[test]
fn one_camera_ray_is_none_to_speak_of() {
    let scene = load("cornell").unwrap();
    let spec = Spec { camera_rays: Some(1), ..Spec::default() };
    let [one, none] = [&spec, &Spec::default()].map(|spec| choose(&scene, spec).unwrap().camera_rays());
    assert_eq!((one, none), (1, 1));
}
