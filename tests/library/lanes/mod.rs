//! The lanes kernel gives the results of the scalar kernel, sample by sample and bit for bit, with every instruction
//! set of this processor. The scalar kernel is the oracle here; the other tests check that it is right.

mod invariance;
mod precision;

use crate::watchdog::Watchdog;
use pathmark::estimator::ESTIMATORS;
use pathmark::film::{Bounds, Piece, PixelSum, TileBuffer};
use pathmark::kernel::{Counts, Kernel, Spec, build, choose};
use pathmark::scene::{SCENES, Scene, load};
use pathmark::simd::{Level, levels};
use statrs::distribution::{ContinuousCDF, Normal};
use std::sync::Arc;
use std::time::Duration;

fn render(kernel: &dyn Kernel, piece: &Piece) -> (TileBuffer, Counts) {
    let mut buffer = TileBuffer::new(piece.bounds);
    let counts = kernel.render(piece, &mut buffer);
    (buffer, counts)
}

/// The numbers of boxes and primitives that rays are tested against depend on the number of lanes; no other count
/// does.
fn without_tests(counts: Counts) -> Counts {
    Counts { box_tests: 0, primitive_tests: 0, ..counts }
}

/// Asserts that lanes with every instruction set render the pieces as the scalar kernel does, and that lanes do render
/// them.
pub(crate) fn assert_same(scene: &Arc<Scene>, spec: &Spec, pieces: &[Piece]) {
    // Lanes choose a hierarchy only for more primitives than the scalar kernel does. Here both use the same
    // accelerator.
    let accelerator = Some(choose(scene, spec).unwrap().accelerator.name.to_string());
    let spec = &Spec { accelerator, ..spec.clone() };
    let scalar = build(scene, &Spec { kernel: "scalar".into(), ..spec.clone() }).unwrap();
    let expected: Vec<_> = pieces.iter().map(|piece| render(&*scalar, piece)).collect();
    for level in levels() {
        let spec = Spec { kernel: "lanes".into(), simd: Some(level.name().into()), ..spec.clone() };
        let what = format!("{}, {}, {}, {}", scene.name, spec.estimator, spec.sampler, level.name());
        let choice = choose(scene, &spec).unwrap();
        assert_eq!((choice.plan.name(), choice.plan.simd(), choice.fallback), ("lanes", level.name(), ""), "{what}");
        let lanes = build(scene, &spec).unwrap();
        for (piece, (buffer, counts)) in pieces.iter().zip(&expected) {
            let (sums, found) = render(&*lanes, piece);
            assert_eq!(found.box_tests > 0, counts.box_tests > 0, "{what}: boxes of {piece:?}");
            assert_eq!(without_tests(found), without_tests(*counts), "{what}: counts of {piece:?}");
            assert!(sums == *buffer, "{what}: sums of {piece:?}");
        }
    }
}

/// Whether lanes render a scene at all; [`unsupported_features_of_lanes_are_reported`] lists the exceptions.
fn is_for_lanes(scene: &Scene, spec: &Spec) -> bool {
    choose(scene, spec).unwrap().plan.name() == "lanes"
}

#[test]
fn every_scene_has_the_scalar_kernels_bits() {
    const SAMPLERS: [&str; 3] = ["independent", "hash", "sobol"];
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let (mut compared, mut scenes) = (0, 0);
    let mut next = SAMPLERS.into_iter().cycle();
    for (name, _) in SCENES {
        watchdog.now(*name);
        let scene = Arc::new(load(name).unwrap());
        let before = compared;
        for estimator in ESTIMATORS {
            // Random numbers do not depend on the scene, so only one scene gets every sampler.
            for sampler in next.by_ref().take(if *name == "cornell" { SAMPLERS.len() } else { 1 }) {
                let (estimator, sampler) = (estimator.name.to_string(), sampler.to_string());
                let spec = Spec { width: 16, height: 12, seed: 3, estimator, sampler, ..Spec::default() };
                if !is_for_lanes(&scene, &spec) {
                    continue;
                }
                let bounds = Bounds { x0: 0, y0: 0, x1: 16, y1: 12 };
                assert_same(&scene, &spec, &[Piece { bounds, samples: 0..4 }]);
                compared += 1;
            }
        }
        scenes += usize::from(compared > before);
    }
    assert!(scenes >= 24 && compared >= 4 * 24, "{compared} comparisons of {scenes} scenes");
}

/// Above 16,384 primitives lanes look up the rows of objects. In double precision the bits equal the scalar kernel's.
/// In single precision the same random numbers lead most paths to the same surfaces, so each channel has nearly the
/// same light.
#[test]
fn scenes_of_many_primitives_have_the_same_colours() {
    let bounds = Bounds { x0: 0, y0: 0, x1: 24, y1: 18 };
    let piece = Piece { bounds, samples: 0..64 };
    for name in ["spheres:20000", "bumpy-ball:20000"] {
        let scene = Arc::new(load(name).unwrap());
        assert!(scene.owners.len() > 1 << 14 && scene.objects.len() < 20, "{name}");
        for estimator in ["bsdf", "mis"] {
            let spec =
                Spec { width: 24, height: 18, estimator: estimator.into(), sampler: "hash".into(), ..Spec::default() };
            assert_same(&scene, &spec, &[Piece { samples: 0..16, ..piece.clone() }]);
            let light = |precision: &str| {
                let spec = Spec { precision: precision.into(), ..spec.clone() };
                let (sums, _) = render(&*build(&scene, &spec).unwrap(), &piece);
                [0, 1, 2].map(|channel| sums.rows().flatten().map(|pixel| pixel.sum[channel]).sum::<f64>())
            };
            let (double, single) = (light("f64"), light("f32"));
            println!("{name}, {estimator}: {double:?} and {single:?}");
            for (double, single) in double.iter().zip(single) {
                assert!((single / double - 1.0).abs() < 0.01, "{name}, {estimator}: {single} instead of {double}");
            }
        }
    }
}

/// Single precision gives the same bits with every instruction set, and no invalid sample. It uses the random numbers
/// of double precision, with fewer digits, so most paths are nearly the same. The remaining difference of both images
/// is within its own standard error: no scene is darker or lighter by more than single precision rounds (z-test of the
/// paired difference, two-sided, family-wise 1e-3).
#[test]
fn single_precision_is_the_same_everywhere_and_converges_to_the_same() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 24, y1: 18 }, samples: 0..32 };
    let mut scores = Vec::new();
    for (name, _) in SCENES {
        watchdog.now(*name);
        let scene = Arc::new(load(name).unwrap());
        for (estimator, sampler) in [("smallpt", "independent"), ("mis", "sobol"), ("nee", "independent")] {
            let (estimator, sampler) = (estimator.to_string(), sampler.to_string());
            let double = Spec { width: 24, height: 18, seed: 3, estimator, sampler, ..Spec::default() };
            if !is_for_lanes(&scene, &double) {
                continue;
            }
            let single = Spec { precision: "f32".into(), ..double.clone() };
            let what = format!("{name}, {}", single.estimator);
            let on = |level: Level, piece: &Piece| {
                let spec = Spec { simd: Some(level.name().into()), ..single.clone() };
                assert_eq!(choose(&scene, &spec).unwrap().plan.precision().name(), "f32");
                let (sums, counts) = render(&*build(&scene, &spec).unwrap(), piece);
                (sums, without_tests(counts))
            };
            let few = Piece { samples: 0..4, ..piece.clone() };
            let expected = on(levels().next().unwrap(), &few);
            for level in levels() {
                assert!(on(level, &few) == expected, "{what}: {}", level.name());
            }
            let (found, counts) = on(levels().next().unwrap(), &piece);
            assert_eq!(counts.invalid, 0, "{what}");
            let (expected, in_double) = render(&*build(&scene, &double).unwrap(), &piece);
            assert!(counts.escaped == 0 || in_double.escaped > 0, "{what}: {} rays escaped", counts.escaped);
            scores.push((difference(&found, &expected), what));
        }
    }
    assert!(scores.len() > 60, "{} comparisons", scores.len());
    let largest = Normal::standard().inverse_cdf(1.0 - 1e-3 / scores.len() as f64 / 2.0);
    for (Difference { mean, error, of }, what) in scores {
        assert!(mean.abs() < largest * error + ROUNDING * of, "{what}: {mean} of {of}, standard error {error}");
    }
}

/// Relative change of a radiance that the roundings along a path may cause.
const ROUNDING: f64 = 1e-5;

/// The mean difference of two images' pixels.
struct Difference {
    mean: f64,
    /// Its standard error.
    error: f64,
    /// The mean pixel.
    of: f64,
}

fn difference(found: &TileBuffer, expected: &TileBuffer) -> Difference {
    let sum = |pixel: &PixelSum| pixel.sum.iter().sum::<f64>();
    let pairs = found.rows().flatten().zip(expected.rows().flatten());
    let differences: Vec<f64> = pairs.map(|(found, expected)| sum(found) - sum(expected)).collect();
    let n = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let square =
        differences.iter().map(|difference| (difference - mean) * (difference - mean)).sum::<f64>() / (n - 1.0);
    let of = expected.rows().flatten().map(sum).sum::<f64>() / n;
    Difference { mean, error: (square / n).sqrt(), of }
}

/// Pieces of any shape: a single pixel, a single sample, more samples than can be in flight, a row, samples from the
/// middle, and none.
#[test]
fn pieces_of_any_shape_have_the_scalar_kernels_bits() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let scene = Arc::new(load("cornell").unwrap());
    let piece = |x0, y0, x1, y1, samples| Piece { bounds: Bounds { x0, y0, x1, y1 }, samples };
    let pieces = [
        piece(5, 7, 6, 8, 0..1),
        piece(20, 20, 21, 21, 0..1500),
        piece(0, 11, 64, 12, 3..5),
        piece(40, 30, 47, 41, 16..48),
        piece(63, 47, 64, 48, 1000..1017),
        piece(9, 9, 12, 10, 4..4),
    ];
    for estimator in ["smallpt", "mis"] {
        watchdog.now(estimator);
        let spec = Spec { width: 64, height: 48, seed: 5, estimator: estimator.into(), ..Spec::default() };
        assert_same(&scene, &spec, &pieces);
    }
}

/// Depth limits, roulette rules and accelerators.
#[test]
fn options_have_the_scalar_kernels_bits() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let scene = Arc::new(load("cornell").unwrap());
    let pieces = [Piece { bounds: Bounds { x0: 0, y0: 0, x1: 32, y1: 24 }, samples: 0..4 }];
    for estimator in ["smallpt", "bsdf", "nee", "mis"] {
        watchdog.now(estimator);
        let spec = Spec { width: 32, height: 24, estimator: estimator.into(), ..Spec::default() };
        for depth in [0, 1, 2, 3, 6, 40] {
            assert_same(&scene, &Spec { max_depth: Some(depth), ..spec.clone() }, &pieces);
        }
        for roulette in ["albedo:0", "throughput:0", "throughput:3", "albedo:9", "constant:0.8"] {
            assert_same(&scene, &Spec { roulette: Some(roulette.into()), ..spec.clone() }, &pieces);
        }
        for accelerator in ["none", "sah"] {
            assert_same(&scene, &Spec { accelerator: Some(accelerator.into()), ..spec.clone() }, &pieces);
        }
    }
}

/// Where lanes cannot render, the scalar kernel does, and the choice states the reason.
#[test]
fn unsupported_features_of_lanes_are_reported() {
    let spec = Spec::default;
    for (scene, spec, reason) in [
        ("cornell-fog", spec(), "fog"),
        ("cornell-lens", spec(), "lens"),
        ("report-c", spec(), "point-light"),
        ("cornell", Spec { estimator: "whitted".into(), ..spec() }, "estimator"),
        ("cornell", Spec { sampler: "stratified".into(), ..spec() }, "sampler"),
        ("cornell", Spec { sampler: "locked".into(), ..spec() }, "sampler"),
        #[cfg(not(feature = "lane-profiles"))]
        ("cornell", Spec { effects: Some("smallpt".into()), ..spec() }, "effects"),
        ("cornell", Spec { effects: Some("surfaces".into()), ..spec() }, "effects"),
        ("cornell", Spec { clamp: Some("subpixel".into()), ..spec() }, "clamp"),
        ("cornell", Spec { epsilon: Some("1e-4".into()), ..spec() }, "epsilon"),
    ] {
        let choice = choose(&load(scene).unwrap(), &spec).unwrap();
        assert_eq!((choice.plan.name(), choice.plan.simd(), choice.fallback), ("scalar", "", reason), "{scene}");
    }
    let asked = choose(&load("cornell").unwrap(), &Spec { kernel: "scalar".into(), ..spec() }).unwrap();
    assert_eq!((asked.plan.name(), asked.fallback), ("scalar", ""));
}

/// A build with more versions has one for mirrors and glass, too. Each renders the bits of the scalar kernel.
#[cfg(feature = "lane-profiles")]
#[test]
fn versions_for_fewer_materials_have_the_scalar_kernels_bits() {
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 24, y1: 18 }, samples: 0..16 };
    for (scene, effects, version) in [
        ("cornell-diffuse", None, "diffuse"),
        ("cornell-diffuse", Some("smallpt"), "smallpt"),
        ("cornell-diffuse", Some("all"), "run-time"),
        ("cornell", None, "run-time"),
        ("cornell", Some("smallpt"), "smallpt"),
    ] {
        let scene = Arc::new(load(scene).unwrap());
        let effects = effects.map(str::to_string);
        let spec = Spec { width: 24, height: 18, estimator: "bsdf".into(), effects, ..Spec::default() };
        assert_eq!(choose(&scene, &spec).unwrap().plan.effects(), Some(version), "{}", scene.name);
        assert_same(&scene, &spec, std::slice::from_ref(&piece));
    }
}

#[test]
fn unknown_levels_are_refused() {
    for (field, spec) in [
        ("simd", Spec { simd: Some("mmx".into()), ..Spec::default() }),
        ("kernel", Spec { kernel: "spectral".into(), ..Spec::default() }),
        ("precision", Spec { precision: "f16".into(), ..Spec::default() }),
    ] {
        let Err(error) = choose(&load("cornell").unwrap(), &spec) else { panic!("{field} is taken") };
        let text = error.to_string();
        assert!(text.contains(field) && text.contains("there is none of that name"), "{text}");
    }
}

#[test]
fn the_scalar_kernel_has_one_precision() {
    let spec = Spec { kernel: "scalar".into(), precision: "f32".into(), ..Spec::default() };
    let Err(error) = choose(&load("cornell").unwrap(), &spec) else { panic!("it is taken") };
    assert!(error.to_string().contains("precision") && error.to_string().contains("f64"), "{error}");
    // Where lanes cannot render, the record states the precision that was used instead.
    let choice = choose(&load("cornell-fog").unwrap(), &Spec { precision: "f32".into(), ..Spec::default() }).unwrap();
    assert_eq!((choice.plan.name(), choice.plan.precision().name(), choice.fallback), ("scalar", "f64", "fog"));
}
