//! Renders compared with exact values, for every way to render a scene.
//!
//! A mean must lie within its interval, and the interval must be narrow: a wide one would detect nothing. A first run
//! with other random numbers estimates how many samples this takes. The scores of the single pixels, which all see the
//! same value, must scatter as chance predicts: means of the whole image hide errors that cancel between pixels.

use super::trials::LEVEL;
use super::{Effort, Trials};
use crate::analysis::z_test::sidak;
use crate::estimator::ESTIMATORS;
use crate::film::{DECOMPOSITIONS, Film};
use crate::kernel::{KERNELS, Spec};
use crate::measure::{Outcome, Settings, Setup, available_threads};
use crate::rendering::spec;
use crate::scene::Scene;
use crate::strategy::STRATEGIES;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::sync::Arc;

/// An upper bound on the comparisons of a section. Too large a bound only makes the level smaller.
const COMPARISONS: usize = 1000;
/// Relative tolerance for the width of a spot and for the rounding error of a sum.
const ROUNDING: f64 = 1e-7;
/// Pixels per row and per column.
const SIDE: u32 = 32;
/// Minimum samples of an image, and of the first run.
const FEWEST: f64 = 8192.0;
/// An event with this expected count fails to occur with probability 1e-6.
const UNSEEN: f64 = 14.0;
/// Factor by which a first run may underestimate the number of samples.
const MARGIN: f64 = 1.3;
/// Relative tolerance for the scatter of the pixels' scores, because samples are not normal.
const TAILS: f64 = 0.07;

/// The estimators that follow all light: those without a depth limit of their own, so not Whitted's.
pub fn full_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().filter(|entry| entry.max_depth.is_none()).map(|entry| entry.name)
}

/// The estimators that find light by hitting it. In an enclosure that glows all over, aiming at one of its points is
/// far noisier than following the surface's sampled direction.
pub fn arriving_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().filter(|entry| !entry.aims && entry.max_depth.is_none()).map(|entry| entry.name)
}

/// The estimators that aim at light.
pub fn aiming_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().filter(|entry| entry.aims).map(|entry| entry.name)
}

/// The full estimators whose sample is a single path. Where nothing splits, the others follow the same path.
pub fn unsplit_estimators() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().filter(|entry| entry.is_one_path && entry.max_depth.is_none()).map(|entry| entry.name)
}

pub fn every_estimator() -> impl Iterator<Item = &'static str> {
    ESTIMATORS.iter().map(|entry| entry.name)
}

/// These estimators, each with every kernel.
pub fn with_kernels(
    estimators: impl Iterator<Item = &'static str>,
) -> impl Iterator<Item = (&'static str, &'static str)> {
    estimators.flat_map(|name| KERNELS.iter().map(move |kernel| (name, kernel.name)))
}

/// The |z| that every comparison of a section must stay below.
pub(super) fn critical() -> f64 {
    super::critical(COMPARISONS)
}

/// Mean of a channel over all samples, and its standard error.
pub fn mean(film: &Film, channel: usize) -> (f64, f64) {
    let (mut n, mut sum, mut square) = (0.0, 0.0, 0.0);
    for pixel in film.pixels() {
        n += f64::from(pixel.count);
        sum += pixel.sum[channel];
        square += pixel.square[channel];
    }
    let mean = sum / n;
    (mean, ((square / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
}

/// Renders with all threads unless the settings say otherwise.
pub(super) fn run(scene: &Scene, settings: Settings) -> Outcome {
    let setup = Setup::for_scene(Arc::new(scene.clone()), settings).expect("settings that fit the scene");
    setup.run(None).expect("a render")
}

/// Renders images of a scene in every way.
pub(super) struct Bench<'a> {
    pub(super) trials: &'a mut Trials,
    /// Largest half-width of an interval as a share of the exact value: quick, thorough.
    pub(super) widest: [f64; 2],
    /// Number of bounces after which paths are cut.
    pub(super) max_depth: Option<u16>,
    /// Roulette rule, if not the estimator's own.
    pub(super) roulette: Option<String>,
    /// Whether all pixels see the same value, so that their scores can be compared with chance.
    pub(super) by_pixel: bool,
    /// Columns and rows.
    pub(super) size: [u32; 2],
    /// Minimum samples of an image.
    pub(super) fewest: f64,
    /// Whether some samples differ from the others, but so rarely that a run may contain none. The error bar then
    /// ignores them. None of them is off by more than the exact value.
    pub(super) rare: bool,
    /// Index of the strategy and decomposition of the next image: the tables are used in turn.
    turn: usize,
}

impl<'a> Bench<'a> {
    pub(super) fn new(trials: &'a mut Trials) -> Self {
        Self {
            trials,
            widest: [1e-2, 1e-3],
            max_depth: None,
            roulette: None,
            by_pixel: true,
            size: [SIDE; 2],
            fewest: FEWEST,
            rare: false,
            turn: 0,
        }
    }

    fn widest(&self) -> f64 {
        match self.trials.effort() {
            Effort::Quick => self.widest[0],
            Effort::Thorough => self.widest[1],
        }
    }

    /// Renders about `samples` samples in all, with the next strategy and decomposition.
    fn render(&mut self, scene: &Scene, spec: Spec, samples: f64) -> Outcome {
        let strategy = &STRATEGIES[self.turn % STRATEGIES.len()];
        let decomposition = &DECOMPOSITIONS[self.turn % DECOMPOSITIONS.len()];
        self.turn += 1;
        let spec = Spec { max_depth: self.max_depth, roulette: self.roulette.clone(), ..spec };
        let spp = ((samples / f64::from(spec.width * spec.height)).ceil() as u32).next_multiple_of(4);
        let settings = Settings {
            spp,
            spec,
            decomposition: decomposition.example.to_string(),
            strategy: strategy.name.to_string(),
            threads: available_threads(),
            ..Settings::default()
        };
        run(scene, settings)
    }

    /// Compares means of channels with exact values, for every kernel and these estimators.
    pub(super) fn each(
        &mut self,
        what: &str,
        scene: &Scene,
        estimators: impl Iterator<Item = &'static str>,
        exact: &[f64],
    ) {
        for (estimator, kernel) in with_kernels(estimators) {
            let spec = spec(estimator, kernel, self.size, 1);
            self.one(&format!("{what}, {estimator}, {kernel}"), scene, &spec, exact, self.by_pixel);
        }
    }

    /// Does the same for every deterministic sampler. Their samples are not independent, so the error bar is an upper
    /// bound, and single pixels are not checked.
    pub(super) fn each_sampler(&mut self, what: &str, scene: &Scene, exact: &[f64]) {
        for sampler in crate::sampling::SAMPLERS.iter().filter(|entry| entry.deterministic) {
            let spec = Spec { sampler: sampler.name.to_string(), ..spec("bsdf", KERNELS[0].name, self.size, 1) };
            self.one(&format!("{what}, {}", sampler.name), scene, &spec, exact, false);
        }
    }

    /// Renders about `samples` samples with every kernel and these estimators. Each film comes with its label.
    pub(super) fn films(
        &mut self,
        scene: &Scene,
        estimators: impl Iterator<Item = &'static str>,
        samples: f64,
    ) -> Vec<(String, Film)> {
        let film = |(estimator, kernel)| {
            let spec = spec(estimator, kernel, self.size, 1);
            (format!("{estimator}, {kernel}"), self.render(scene, spec, samples).film)
        };
        with_kernels(estimators).map(film).collect()
    }

    /// Number of samples that makes the interval of every channel narrow enough.
    fn needed(&mut self, scene: &Scene, spec: &Spec, exact: &[f64]) -> f64 {
        let mut samples = self.fewest;
        for seed in [91, 92] {
            let film = self.render(scene, Spec { seed, ..spec.clone() }, samples).film;
            let n: f64 = film.pixels().iter().map(|pixel| f64::from(pixel.count)).sum();
            let shares = exact.iter().enumerate().map(|(channel, exact)| {
                let share = critical() * mean(&film, channel).1 / (self.widest() * exact);
                if *exact > 0.0 { share * share * n } else { 0.0 }
            });
            let needed = MARGIN * shares.fold(0.0, f64::max);
            if needed < 16.0 * n {
                return needed;
            }
            samples = needed / 16.0;
        }
        16.0 * samples
    }

    fn one(&mut self, what: &str, scene: &Scene, spec: &Spec, exact: &[f64], by_pixel: bool) {
        let most = self.trials.times(20_000_000, 20_000_000_000) as f64;
        let samples = self.needed(scene, spec, exact);
        if samples > most {
            self.trials.holds(what, format_args!("at most {most:.0e} samples"), format_args!("{samples:.0e}"), false);
            return;
        }
        let outcome = self.render(scene, Spec { seed: 31, ..spec.clone() }, samples.max(self.fewest));
        if outcome.counts.invalid > 0 {
            self.trials.never(what, "invalid samples", outcome.counts.invalid, outcome.counts.paths);
        }
        for (channel, exact) in exact.iter().enumerate() {
            let what = if channel > 0 { format!("{what}, channel {channel}") } else { what.to_string() };
            self.hold(&what, &outcome.film, channel, *exact, by_pixel);
        }
    }

    /// Compares the mean of a channel with its exact value, and the scores of its pixels with chance.
    pub(super) fn hold(&mut self, what: &str, film: &Film, channel: usize, exact: f64, by_pixel: bool) {
        let (found, error) = mean(film, channel);
        let (width, widest) = (critical() * error, self.widest());
        let n: f64 = film.pixels().iter().map(|pixel| f64::from(pixel.count)).sum();
        let unseen = if self.rare { UNSEEN / n } else { 0.0 };
        let is_exact = (found - exact).abs() <= width + (ROUNDING + unseen) * exact;
        let is_narrow = width <= widest * exact;
        self.trials.holds(
            what,
            format_args!("{exact:?} +- {:.2} %", 100.0 * widest),
            format_args!("{found:?} +- {width:.1e}"),
            is_exact && is_narrow,
        );
        if by_pixel && error > 1e-6 * exact {
            self.pixels(what, film, channel, exact);
        }
    }

    /// Checks that the sum of the pixels' squared scores agrees with chance.
    fn pixels(&mut self, what: &str, film: &Film, channel: usize, exact: f64) {
        let n: f64 = film.pixels().iter().map(|pixel| f64::from(pixel.count)).sum();
        let error = mean(film, channel).1;
        let variance = error * error * (n - 1.0);
        let squares: f64 = film
            .pixels()
            .iter()
            .map(|pixel| {
                let deviation = pixel.mean()[channel] - exact;
                deviation * deviation * f64::from(pixel.count) / variance
            })
            .sum();
        let pixels = film.pixels().len() as f64;
        let chance = ChiSquared::new(pixels).expect("a number of pixels");
        let tail = 0.5 * sidak(LEVEL, COMPARISONS).expect("a level");
        let low = (1.0 - TAILS) * chance.inverse_cdf(tail) / pixels;
        let high = (1.0 + TAILS) * chance.inverse_cdf(1.0 - tail) / pixels;
        self.trials.holds(
            format!("{what}: pixels"),
            format_args!("chi2 of {low:.2} to {high:.2} a pixel"),
            format_args!("{:.3}", squares / pixels),
            (low..high).contains(&(squares / pixels)),
        );
    }
}
