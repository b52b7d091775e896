//! Invalid radiance: NaN, infinite, negative.

use crate::Trials;
use crate::effect::EffectSet;
use crate::estimator::{AnyEstimator, ESTIMATORS, Estimator, Options, Probe, any_estimator};
use crate::film::DECOMPOSITIONS;
use crate::kernel::KERNELS;
use crate::math::{Ray, Rgb};
use crate::measure::{InvalidSample, Outcome, Settings, Setup};
use crate::rendering::{run, spec};
use crate::sampling::{SampleKey, Sampler};
use crate::scene::{Scene, load};
use crate::strategy::STRATEGIES;

const WIDTH: u32 = 16;
const HEIGHT: u32 = 12;
const SPP: u32 = 32;
const TOLD: usize = 10;

/// An estimator that replaces some samples by an invalid value.
struct Spoilt {
    estimator: Box<dyn AnyEstimator>,
    instead: f64,
}

/// About one sample in 31, scattered over the image.
fn is_spoilt(pixel: u32, sample: u32) -> bool {
    ((pixel * SPP + sample).wrapping_mul(2_654_435_761) >> 16).is_multiple_of(31)
}

impl Estimator for Spoilt {
    const SPP_MULTIPLE: u32 = SPP;
    // Estimators that do not aim at lights may have them in the scene.
    const AIMS: bool = true;

    fn sample<S: Sampler, X: EffectSet, P: Probe>(
        &self,
        scene: &Scene,
        ray: Ray,
        key: SampleKey,
        sampler: &S,
        probe: &mut P,
    ) -> Rgb {
        let radiance = self.estimator.estimate(scene, ray, key, sampler, probe);
        if is_spoilt(key.pixel, key.sample) { Rgb { g: self.instead, ..radiance } } else { radiance }
    }
}

/// Renders with an estimator whose spoilt samples have `instead` as their green channel.
fn render(settings: Settings, instead: f64) -> Outcome {
    let estimator = any_estimator(&settings.spec.estimator, Options::default()).expect("an estimator of the table");
    let setup = Setup::prepare(settings).expect("settings that fit");
    setup.with("spoilt", Spoilt { estimator, instead }).expect("a kernel").run(None).expect("an image")
}

pub(super) fn injected(trials: &mut Trials) {
    let all = (0..HEIGHT).flat_map(|y| (0..WIDTH).flat_map(move |x| (0..SPP).map(move |sample| (y, x, sample))));
    let spoilt: Vec<InvalidSample> = all
        .filter(|(y, x, sample)| is_spoilt(y * WIDTH + x, *sample))
        .map(|(y, x, sample)| InvalidSample { y, x, sample })
        .collect();
    let settings = |estimator: &str, strategy: &str, decomposition: &str| {
        let (spec, scene) = (spec(estimator, KERNELS[0].name, [WIDTH, HEIGHT], 3), "cornell".to_string());
        let (strategy, decomposition) = (strategy.to_string(), decomposition.to_string());
        Settings { scene, spp: SPP, spec, threads: 2, strategy, decomposition, ..Settings::default() }
    };
    let mut look = |name: String, settings: &Settings, bad: f64| {
        let outcome = render(settings.clone(), bad);
        trials.same(format!("{name}: counted"), &(spoilt.len() as u64), &outcome.counts.invalid);
        trials.same(format!("{name}: told"), &&spoilt[..TOLD], &outcome.invalid.as_slice());
        let pixels = outcome.film.pixels().iter();
        let broken =
            pixels.filter(|pixel| !pixel.sum.iter().chain(&pixel.square).all(|sum| *sum >= 0.0 && sum.is_finite()));
        trials.never(
            format!("{name}: in the film"),
            "pixels that are no radiance",
            broken.count() as u64,
            u64::from(WIDTH * HEIGHT),
        );
        // They are left out of the sum but not of the sample count: as if they were black.
        let samples: u64 = outcome.film.pixels().iter().map(|pixel| u64::from(pixel.count)).sum();
        trials.same(format!("{name}: samples"), &u64::from(WIDTH * HEIGHT * SPP), &samples);
        outcome.checksum
    };
    for estimator in ESTIMATORS {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
            let settings = settings(estimator.name, "work-stealing", "tiles:8x8");
            look(format!("{}, {bad}", estimator.name), &settings, bad);
        }
    }
    let mut checksums = Vec::new();
    for decomposition in DECOMPOSITIONS {
        checksums.push(look(
            decomposition.example.into(),
            &settings("bsdf", "fixed-pool", decomposition.example),
            f64::NAN,
        ));
    }
    for strategy in STRATEGIES {
        checksums.push(look(strategy.name.into(), &settings("bsdf", strategy.name, "samples:16:8x8"), f64::NAN));
    }
    checksums.dedup();
    trials.same("one image of all", &1, &checksums.len());
    for kernel in KERNELS {
        spoilt_lamp(kernel.name, trials);
    }
}

/// A lamp that emits NaN, which the scene reader would refuse. Every kernel leaves out the samples that hit it.
fn spoilt_lamp(kernel: &str, trials: &mut Trials) {
    let mut scene = load("cornell").expect("a shipped scene");
    let lamp = scene.objects.iter_mut().find(|object| object.emission != Rgb::BLACK).expect("a lamp");
    lamp.emission = Rgb { r: f64::NAN, g: f64::NAN, b: f64::NAN };
    let outcome = run(&scene, spec("bsdf", kernel, [WIDTH, HEIGHT], 1), SPP);
    let some = (1..outcome.counts.paths).contains(&outcome.counts.invalid);
    trials.holds(format!("{kernel}: a spoilt lamp"), "some of the samples", outcome.counts.invalid, some);
    let black = outcome.film.pixels().iter().all(|pixel| pixel.sum == [0.0; 3]);
    trials.same(format!("{kernel}: the others are black"), &true, &black);
    trials.same(format!("{kernel}: told"), &TOLD, &outcome.invalid.len());
}
