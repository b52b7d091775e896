//! The price of an accuracy, estimated by a pilot: some seeds are rendered, and their images are compared with each other.
//! No reference is needed. The pilot's seeds belong to no image, so a render that is paid for later is not judged by the
//! samples that set its price.
//!
//! Times come from other runs: all pilots take turns in adjacent pairs ([`super::pairs`]), in several processes, because a
//! process has one memory layout for its whole life.

use super::pairs::{Contestant, USUAL_PAIRS, run_pairs};
use super::{CellJob, PointJob, Progress, SceneVersion};
use crate::analysis::Estimate;
use crate::analysis::adjacent_pairs::{by_process, paired_ratio};
use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mean::geometric_interval;
use crate::analysis::price::{Law, Renderer};
use crate::analysis::quantile::median;
use crate::analysis::ranking::{Turn, ratios_in_pairs};
use crate::analysis::tail::{Tail, tail};
use crate::error::{Error, InputError, Result};
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::measure::{LARGEST_BYTES, Rounds, Settings, TimingConcerns};
use crate::sampling::{REFERENCE_SEEDS, is_spread};
use std::collections::BTreeMap;

const PILOT_SEEDS: u64 = REFERENCE_SEEDS >> 1;
/// Points of each seed's curve, each with twice the samples of the one before: enough to fit an exponent.
const POINTS: u32 = 5;
/// Processes in which the times are measured: one more than an interval needs.
const PROCESSES: u32 = 4;

/// The pilot of one renderer.
#[derive(Debug, Clone, PartialEq)]
pub struct Pilot {
    /// Its samples per pixel are those of each seed.
    pub settings: Settings,
    pub seeds: u32,
}

pub struct Piloted {
    pub renderer: Renderer,
    /// The tail of the pixels' values over seeds. If one value of one pixel makes up much of the variance, the price
    /// depends on whether the pilot met it.
    pub tail: Tail,
    pub doubts: TimingConcerns,
    /// Seconds for one sample in every pixel, by process and pair.
    per_spp: BTreeMap<Turn, f64>,
}

impl Piloted {
    /// Seconds of this renderer over seconds of the other one until the RMSE falls to that goal. The ratio of times comes
    /// from pairs of runs, the numbers of samples from independent seeds.
    pub fn seconds_over(&self, other: &Self, rmse: f64, level: f64) -> Option<Estimate> {
        let ratios = by_process(ratios_in_pairs(&self.per_spp, &other.per_spp));
        let times = paired_ratio(&ratios, level)?.ratio;
        let [own, others] = [self, other].map(|piloted| piloted.renderer.price(rmse).map(|price| price.spp));
        times.times(&own?.times(&others?.inverse()?)?)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paid {
    pub seconds: f64,
    /// Root of half the mean squared difference of their images: the error of either, if there is no bias.
    pub rmse: f64,
}

/// The law by which the error falls with that sampler.
pub fn law_of(sampler: &str) -> Law {
    if is_spread(sampler) { Law::Fitted } else { Law::Independent }
}

fn with_seed(settings: &Settings, spp: u32, seed: u64) -> Settings {
    Settings { spp, spec: Spec { seed, ..settings.spec.clone() }, ..settings.clone() }
}

/// Renders the pilots, and times them side by side. Intervals have the confidence `level`. Those of `others` may fail, and
/// are `None` then.
pub fn run_pilots(
    lab: &Lab,
    pilots: &[Pilot],
    others: &[Pilot],
    level: f64,
    progress: &dyn Progress,
) -> Result<(Vec<Piloted>, Vec<Option<Piloted>>)> {
    let own = pilots.iter().map(|pilot| PilotRun::new(lab, pilot, pilots.len()));
    let mut own = own.collect::<Result<Vec<PilotRun>>>()?;
    let mut others: Vec<Option<PilotRun>> =
        others.iter().map(|pilot| PilotRun::new(lab, pilot, others.len()).ok()).collect();
    let mut runs: Vec<&mut PilotRun> = own.iter_mut().chain(others.iter_mut().flatten()).collect();
    progress.begin("pilot", runs.iter().map(|run| u64::from(run.pilot.seeds)).sum());
    let mut done = 0;
    for run in &mut runs {
        for seed in 0..run.pilot.seeds {
            run.render(lab, PILOT_SEEDS + u64::from(seed))?;
            done += 1;
            progress.advance(done);
        }
    }
    progress.end();
    time(lab, &mut runs, progress)?;
    let own = own.into_iter().map(|run| run.end(level)).collect::<Result<Vec<Piloted>>>()?;
    Ok((own, others.into_iter().map(|run| run?.end(level).ok()).collect()))
}

/// Times the pilots in adjacent pairs, in several processes.
fn time(lab: &Lab, runs: &mut [&mut PilotRun], progress: &dyn Progress) -> Result<()> {
    progress.begin("pilot times", u64::from(PROCESSES));
    let program = std::env::current_exe().map_err(|e| format!("finding this program: {e}"));
    for process in 0..PROCESSES {
        let mut group = Vec::new();
        for (number, run) in runs.iter().enumerate() {
            let Settings { spp, .. } = run.pilot.settings;
            let settings = with_seed(&run.pilot.settings, spp, PILOT_SEEDS + u64::from(process));
            let scene = SceneVersion::of(&lab.prepare(settings.clone())?);
            let points = vec![PointJob { cell: number.to_string(), spp, image: None }];
            let job = CellJob { points, repetition: process, settings, scene, ..CellJob::default() };
            group.push(Contestant::new(job, program.clone(), None));
        }
        for (at, row) in run_pairs(&mut group, USUAL_PAIRS, "price", process) {
            let Some(seconds) = row.makespan_s.filter(|_| row.error.is_empty()) else {
                return Err(Error::Check(format!("the pilot's run failed: {}", row.error)));
            };
            let run = &mut *runs[at];
            run.per_spp.insert((process, row.pair), seconds / f64::from(row.spp));
            run.doubts.add(&row.warnings);
        }
        progress.advance(u64::from(process) + 1);
    }
    progress.end();
    Ok(())
}

/// The pilot of one renderer, and what its runs have shown so far.
struct PilotRun {
    pilot: Pilot,
    law: Law,
    points: Vec<u32>,
    /// The images of each point, seed by seed.
    images: Vec<Vec<Vec<f64>>>,
    per_spp: BTreeMap<Turn, f64>,
    doubts: TimingConcerns,
}

impl PilotRun {
    /// Checks a pilot, one of `many`.
    fn new(lab: &Lab, pilot: &Pilot, many: usize) -> Result<Self> {
        let Pilot { settings, seeds } = pilot;
        let law = law_of(&settings.spec.sampler);
        let fewest = lab.prepare(with_seed(settings, settings.spp, PILOT_SEEDS))?.fewest_spp();
        if !settings.spp.is_multiple_of(fewest) {
            let problem = format!("is not a multiple of {fewest}, the fewest samples that make an image");
            return Err(InputError::new("pilot-spp", settings.spp.to_string(), problem).into());
        }
        let count = if law == Law::Independent { 1 } else { POINTS };
        let pixels = u64::from(settings.spec.width) * u64::from(settings.spec.height);
        let images = u64::from(*seeds) * u64::from(count) * many as u64;
        let bytes = pixels * images * size_of::<[f64; 3]>() as u64;
        if bytes > LARGEST_BYTES {
            let problem = format!("keeps {} GiB of images in memory", bytes >> 30);
            let error = InputError::new("pilot-seeds", seeds.to_string(), problem);
            let allowed = format!("at most {} GiB, by fewer seeds or a smaller --size", LARGEST_BYTES >> 30);
            return Err(error.allowed(allowed).into());
        }
        let halved =
            (0..count).map(|times| settings.spp >> times).take_while(|spp| spp.is_multiple_of(fewest) && *spp > 0);
        let mut points: Vec<u32> = halved.collect();
        points.reverse();
        let images = vec![Vec::new(); points.len()];
        let (per_spp, doubts) = (BTreeMap::new(), TimingConcerns::default());
        Ok(Self { pilot: pilot.clone(), law, points, images, per_spp, doubts })
    }

    fn render(&mut self, lab: &Lab, seed: u64) -> Result<()> {
        let settings = &self.pilot.settings;
        let mut rounds = Rounds::new(lab.prepare(with_seed(settings, settings.spp, seed))?)?;
        for (&spp, images) in self.points.iter().zip(&mut self.images) {
            rounds.extend_to(spp, None)?;
            images.push(rounds.film().image().pixels.into_flattened());
        }
        Ok(())
    }

    fn end(self, level: f64) -> Result<Piloted> {
        let Self { law, points, images, per_spp, doubts, .. } = self;
        let at: Vec<f64> = points.iter().map(|&spp| f64::from(spp)).collect();
        let seen: Vec<Vec<&[f64]>> = images.iter().map(|of| of.iter().map(Vec::as_slice).collect()).collect();
        let curves = SeedCurves::of_images(&at, &seen);
        // A process is one value, however many runs it has.
        let of_processes = by_process(per_spp.iter().map(|((process, _), seconds)| (*process, *seconds)));
        let medians: Option<Vec<f64>> = of_processes.iter().map(|own| median(own)).collect();
        let seconds = medians.and_then(|medians| geometric_interval(&medians, level));
        match curves.zip(seconds).zip(images.last().and_then(|of| tail_over_seeds(of))) {
            Some(((curves, seconds_per_spp), tail)) => {
                Ok(Piloted { renderer: Renderer { curves, law, seconds_per_spp }, tail, doubts, per_spp })
            }
            None => Err(Error::Check("the pilot gives no estimate of error and time".to_string())),
        }
    }
}

fn tail_over_seeds(images: &[Vec<f64>]) -> Option<Tail> {
    let length = images.first()?.len();
    let values: Vec<Vec<f64>> = (0..length).map(|at| images.iter().map(|image| image[at]).collect()).collect();
    tail(values.iter().map(Vec::as_slice))
}

/// Renders two seeds, the settings' own and the next, at `spp` samples per pixel; measures their time and error.
pub fn pay(lab: &Lab, settings: &Settings, spp: u32, progress: &dyn Progress) -> Result<Paid> {
    let mut images = Vec::new();
    let mut seconds = 0.0;
    for index in 0..2_u64 {
        let setup = lab.prepare(with_seed(settings, spp, settings.spec.seed + index))?;
        progress.begin(&format!("paying {} of 2: {spp} spp", index + 1), setup.jobs() as u64);
        let outcome = setup.run(Some(&|done| progress.advance(done)))?;
        progress.end();
        seconds += 0.5 * outcome.makespan_s;
        images.push(outcome.film.image());
    }
    let (first, second) = (images[0].pixels.as_flattened(), images[1].pixels.as_flattened());
    let squares: f64 = first.iter().zip(second).map(|(a, b)| (a - b) * (a - b)).sum();
    Ok(Paid { seconds, rmse: (0.5 * squares / first.len() as f64).sqrt() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piloted(scale: f64, of_process: impl Fn(u32) -> f64) -> Piloted {
        let curves: Vec<_> = [0.99, 1.0, 1.01].iter().map(|factor| vec![(16.0, factor * scale / 16.0)]).collect();
        let turns = (0..4).flat_map(|process| (0..2).map(move |pair| (process, Some(pair))));
        let per_spp: BTreeMap<Turn, f64> = turns.map(|turn| (turn, of_process(turn.0))).collect();
        let medians: Vec<f64> = (0..4).map(of_process).collect();
        let renderer = Renderer {
            curves: SeedCurves::of_errors(&curves).unwrap(),
            law: Law::Independent,
            seconds_per_spp: geometric_interval(&medians, 0.95).unwrap(),
        };
        Piloted { renderer, tail: Tail::default(), doubts: TimingConcerns::default(), per_spp }
    }

    /// The machine is up to four times slower in some processes, for both renderers alike: their seconds are unknown within
    /// a factor, and their ratio is known. Half the variance and three times the seconds a sample: 3/2.
    #[test]
    fn what_slows_both_leaves_their_ratio() {
        let slow = |process: u32| f64::from(process + 1);
        let layout = |process: u32| 1.0 + 0.01 * (f64::from(process) - 1.5);
        let (own, other) = (piloted(1.0, |process| 3.0 * slow(process) * layout(process)), piloted(2.0, slow));
        let seconds = other.renderer.price(0.1).unwrap().seconds;
        assert!(seconds.interval.high > 2.0 * seconds.value, "{seconds:?}");
        let ratio = own.seconds_over(&other, 0.1, 0.95).unwrap();
        assert!((ratio.value - 1.5).abs() < 1e-3, "{ratio:?}");
        assert!(ratio.interval.low > 1.4 && ratio.interval.high < 1.6, "{ratio:?}");
    }
}
