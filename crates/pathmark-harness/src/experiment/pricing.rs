//! The price of an accuracy, estimated by a pilot: some seeds are rendered and timed, and their images are compared
//! with each other. No reference is needed. The pilot's seeds belong to no image, so a render that is paid for later is
//! not judged by the samples that set its price.

use super::Progress;
use crate::analysis::Estimate;
use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mean::geometric_interval;
use crate::analysis::price::{Law, Renderer};
use crate::analysis::tail::{Tail, tail};
use crate::error::{Error, InputError, Result};
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::measure::{LARGEST_BYTES, Rounds, Settings, TimingConcerns};
use crate::sampling::{REFERENCE_SEEDS, is_spread};

const PILOT_SEEDS: u64 = REFERENCE_SEEDS >> 1;
/// Points of each seed's curve, each with twice the samples of the one before: enough to fit an exponent.
const POINTS: u32 = 5;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pilot {
    pub spp: u32,
    pub seeds: u32,
}

pub struct Piloted {
    pub renderer: Renderer,
    /// The tail of the pixels' values over seeds. If one value of one pixel makes up much of the variance, the price
    /// depends on whether the pilot met it.
    pub tail: Tail,
    pub doubts: TimingConcerns,
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

impl Pilot {
    /// Renders the pilot. Intervals have the confidence `level`.
    pub fn run(&self, lab: &Lab, settings: &Settings, level: f64, progress: &dyn Progress) -> Result<Piloted> {
        let mut run = self.begin(lab, settings, 1)?;
        self.render(lab, std::slice::from_mut(&mut run), progress)?;
        run.end(level)
    }

    /// Renders the pilots of several settings side by side: each seed by all of them, in alternating order, so that drift
    /// of the machine's speed affects them equally.
    pub fn run_side_by_side(
        &self,
        lab: &Lab,
        each: &[Settings],
        level: f64,
        progress: &dyn Progress,
    ) -> Result<Vec<Piloted>> {
        let runs = each.iter().map(|settings| self.begin(lab, settings, each.len()));
        let mut runs = runs.collect::<Result<Vec<_>>>()?;
        self.render(lab, &mut runs, progress)?;
        runs.into_iter().map(|run| run.end(level)).collect()
    }

    /// Checks the settings, one of `many`.
    fn begin(self, lab: &Lab, settings: &Settings, many: usize) -> Result<PilotRun> {
        let law = law_of(&settings.spec.sampler);
        let fewest = lab.prepare(with_seed(settings, self.spp, PILOT_SEEDS))?.fewest_spp();
        if !self.spp.is_multiple_of(fewest) {
            let problem = format!("is not a multiple of {fewest}, the fewest samples that make an image");
            return Err(InputError::new("pilot-spp", self.spp.to_string(), problem).into());
        }
        let count = if law == Law::Independent { 1 } else { POINTS };
        let pixels = u64::from(settings.spec.width) * u64::from(settings.spec.height);
        let images = u64::from(self.seeds) * u64::from(count) * many as u64;
        let bytes = pixels * images * size_of::<[f64; 3]>() as u64;
        if bytes > LARGEST_BYTES {
            let problem = format!("keeps {} GiB of images in memory", bytes >> 30);
            let error = InputError::new("pilot-seeds", self.seeds.to_string(), problem);
            let allowed = format!("at most {} GiB, by fewer seeds or a smaller --size", LARGEST_BYTES >> 30);
            return Err(error.allowed(allowed).into());
        }
        let halved = (0..count).map(|times| self.spp >> times).take_while(|spp| spp.is_multiple_of(fewest) && *spp > 0);
        let mut points: Vec<u32> = halved.collect();
        points.reverse();
        // The first run of a process is slower than the rest.
        lab.prepare(with_seed(settings, fewest, PILOT_SEEDS))?.run(None)?;
        let images = vec![Vec::new(); points.len()];
        Ok(PilotRun {
            settings: settings.clone(),
            law,
            points,
            images,
            per_spp: Vec::new(),
            doubts: TimingConcerns::default(),
        })
    }

    fn render(self, lab: &Lab, runs: &mut [PilotRun], progress: &dyn Progress) -> Result<()> {
        progress.begin("pilot", u64::from(self.seeds) * runs.len() as u64);
        let mut done = 0;
        for seed in 0..self.seeds {
            let mut order: Vec<&mut PilotRun> = runs.iter_mut().collect();
            if seed % 2 == 1 {
                order.reverse();
            }
            for run in order {
                run.render(lab, self.spp, PILOT_SEEDS + u64::from(seed))?;
                done += 1;
                progress.advance(done);
            }
        }
        progress.end();
        Ok(())
    }
}

/// The pilot of one renderer, and what its seeds have shown so far.
struct PilotRun {
    settings: Settings,
    law: Law,
    points: Vec<u32>,
    /// The images of each point, seed by seed.
    images: Vec<Vec<Vec<f64>>>,
    per_spp: Vec<f64>,
    doubts: TimingConcerns,
}

impl PilotRun {
    fn render(&mut self, lab: &Lab, spp: u32, seed: u64) -> Result<()> {
        let pixels = u64::from(self.settings.spec.width) * u64::from(self.settings.spec.height);
        let mut rounds = Rounds::new(lab.prepare(with_seed(&self.settings, spp, seed))?)?;
        let (mut seconds, mut samples) = (0.0, 0);
        for (&spp, images) in self.points.iter().zip(&mut self.images) {
            let times = rounds.extend_to(spp, None)?;
            seconds += times.makespan_s;
            samples += times.paths;
            images.push(rounds.film().image().pixels.into_flattened());
        }
        self.per_spp.push(seconds * pixels as f64 / samples as f64);
        let warnings: Vec<String> = rounds.outcome().warnings.iter().map(ToString::to_string).collect();
        self.doubts.add(&warnings.join(";"));
        Ok(())
    }

    fn end(self, level: f64) -> Result<Piloted> {
        let Self { law, points, images, per_spp, doubts, .. } = self;
        let at: Vec<f64> = points.iter().map(|&spp| f64::from(spp)).collect();
        let seen: Vec<Vec<&[f64]>> = images.iter().map(|of| of.iter().map(Vec::as_slice).collect()).collect();
        let curves = SeedCurves::of_images(&at, &seen);
        let seconds: Option<Estimate> = geometric_interval(&per_spp, level);
        match curves.zip(seconds).zip(images.last().and_then(|of| tail_over_seeds(of))) {
            Some(((curves, seconds_per_spp), tail)) => {
                Ok(Piloted { renderer: Renderer { curves, law, seconds_per_spp }, tail, doubts })
            }
            None => Err(Error::Check("the pilot's seeds give no estimate of error and time".to_string())),
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
