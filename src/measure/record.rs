//! One row of `records.csv`: one repetition of one cell, with everything that is needed to repeat it.

use super::{Outcome, Settings, Setup, Warning, utc_now};
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::image_io::Image;
use crate::kernel::Choice;
use crate::kernel::workload::WORKLOAD;
use crate::metric;
use crate::scene::Filter;
use crate::simd::Precision;
use serde::{Deserialize, Serialize};

/// Version of the columns.
pub const SCHEMA: u32 = 6;

/// A row. A run that failed is a row too: `error` says why, and what was not measured is empty.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Version of the columns.
    pub schema: u32,
    /// Name of the experiment; `render` outside of one.
    pub experiment: String,
    /// The cell's settings in one word; with `repetition`, unique within an experiment.
    pub cell: String,
    /// Scene.
    pub scene: String,
    /// Hash of the scene's definition.
    pub scene_hash: String,
    /// Effect profile that the kernel was compiled for.
    pub effects: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples per pixel.
    pub spp: u32,
    /// Seed.
    pub seed: u64,
    /// Estimator.
    pub estimator: String,
    /// Sampler.
    pub sampler: String,
    /// Kernel that rendered.
    pub kernel: String,
    /// Why it was not the one that was asked for; empty if it was.
    pub kernel_fallback: String,
    /// Floating-point format of the kernel that rendered.
    pub precision: String,
    /// Instruction set of its lanes; empty if it had none.
    pub simd: String,
    /// What the search for the nearest primitive goes by.
    pub accelerator: String,
    /// After so many bounces paths were cut; empty if only their throughput ended them.
    pub max_depth: Option<u16>,
    /// How chance ended paths; empty if it did not.
    pub roulette: String,
    /// Whether tiles had as many samples as their noise called for; `spp` is their mean then.
    pub adaptive: bool,
    /// RMSE at which the render was to stop; empty if it went by samples or time alone.
    pub target_error: Option<f64>,
    /// Seconds of rendering after which it was to stop.
    pub time_limit_s: Option<f64>,
    /// How often jobs were handed out.
    pub rounds: Option<u32>,
    /// What was clamped: `subpixel` or `recursion`, and behind a colon to how much if not to 1; empty if nothing was.
    pub clamp: String,
    /// Pixel filter; empty if it was the camera's own.
    pub filter: String,
    /// Distance below which nothing was hit; empty if there was none.
    pub epsilon: String,
    /// Whether an option was on that changes what the image converges to.
    pub biased: bool,
    /// How the film was cut.
    pub decomposition: String,
    /// Strategy.
    pub strategy: String,
    /// How pieces got into the film.
    pub output: String,
    /// Workers asked for.
    pub threads: usize,
    /// Number of the repetition, from 0.
    pub repetition: u32,
    /// Position in the order in which the sweep really ran.
    pub order: u64,
    /// Jobs.
    pub jobs: usize,
    /// What was measured; empty if the run failed.
    pub workers_used: Option<u32>,
    /// Seconds to build the kernel and what accelerates the scene.
    pub build_s: Option<f64>,
    /// Seconds to find out what the pieces will cost, where their order depends on it.
    pub pilot_s: Option<f64>,
    /// Seconds to make the strategy (its pool, if it keeps one).
    pub setup_s: Option<f64>,
    /// Seconds from handing the jobs to the strategy until it returned.
    pub makespan_s: Option<f64>,
    /// Seconds to put the pieces together.
    pub merge_s: Option<f64>,
    /// CPU seconds in the program during the makespan, over all threads.
    pub cpu_user_s: Option<f64>,
    /// CPU seconds in the kernel of the operating system, likewise.
    pub cpu_system_s: Option<f64>,
    /// Seconds inside jobs, over all workers.
    pub busy_sum_s: Option<f64>,
    /// Seconds inside jobs of the busiest worker.
    pub busy_max_s: Option<f64>,
    /// Seconds between jobs of workers that had jobs to come, over all workers, the time before the first included.
    pub gap_sum_s: Option<f64>,
    /// Seconds from each worker's last job to the end of the run, over all workers. With busy time and gaps it makes workers x makespan.
    pub tail_sum_s: Option<f64>,
    /// Shortest job.
    pub job_min_s: Option<f64>,
    /// Median job.
    pub job_median_s: Option<f64>,
    /// Longest job.
    pub job_max_s: Option<f64>,
    /// Times that a thread gave up its processor.
    pub voluntary_switches: Option<i64>,
    /// Times that a thread had to.
    pub involuntary_switches: Option<i64>,
    /// CPU seconds of everything else on the machine during the makespan.
    pub foreign_cpu_s: Option<f64>,
    /// Most memory that the process ever had.
    pub peak_rss_bytes: Option<i64>,
    /// Samples.
    pub paths: Option<u64>,
    /// Rays.
    pub rays: Option<u64>,
    /// Boxes that rays were tested against.
    pub box_tests: Option<u64>,
    /// Primitives that rays were tested against.
    pub primitive_tests: Option<u64>,
    /// Rays that met nothing.
    pub escaped: Option<u64>,
    /// Paths cut at the bounce limit.
    pub truncated: Option<u64>,
    /// Samples that were NaN, infinite or negative.
    pub invalid_samples: Option<u64>,
    /// RMSE in linear radiance as the samples' own variance tells it; too large where samples are stratified.
    pub estimated_rmse: Option<f64>,
    /// Mean squared error in linear radiance, cross form: free of the reference's noise, and so sometimes below zero.
    pub mse: Option<f64>,
    /// Its square root, where there is one.
    pub rmse: Option<f64>,
    /// Likewise on display values (clamped, gamma 2.2), in units of the display's range.
    pub mse_display: Option<f64>,
    /// Its square root, where there is one.
    pub rmse_display: Option<f64>,
    /// Mean squared error over the squared reference, cross form.
    pub rel_mse: Option<f64>,
    /// What the samples themselves say of the squared error: the mean over pixels of the variance of a pixel's mean, for independent samples. Where
    /// subpixels or a sampler spread the samples evenly, the true error is below it.
    pub variance: Option<f64>,
    /// Mean squared error, cross form, over the pixels of the object that the experiment names; NaN if it is in none.
    pub object_mse: Option<f64>,
    /// Share of pixels whose display value is within 0.05 of the reference's in every channel: the share that is accurate.
    pub within_tolerance: Option<f64>,
    /// Pixels that are brighter than the reference by more than 1, the display's white, in some channel.
    pub fireflies: Option<u64>,
    /// Mean radiance over pixels and channels.
    pub mean_radiance: Option<f64>,
    /// Pixels in which every channel is 0.
    pub black_pixels: Option<u64>,
    /// Seconds to write the image; empty if it was not kept.
    pub image_write_s: Option<f64>,
    /// Checksum of the film; empty if the sampler gives other numbers in each run.
    pub checksum: String,
    /// Doubts, separated by semicolons.
    pub warnings: String,
    /// Why it failed; empty if it did not.
    pub error: String,
    /// Version control revision of the sources.
    pub commit: String,
    /// Whether they had uncommitted changes.
    pub dirty: bool,
    /// When it started; empty if the system's clock shows no date from 1970 to 9999.
    pub started_utc: String,
}

/// See [`Record::within_tolerance`].
const TOLERANCE: f64 = 0.05;

/// See [`Record::fireflies`].
const WHITE: f64 = 1.0;

/// The errors of an image, where there was a reference.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// See [`Record::mse`].
    pub mse: Option<f64>,
    /// See [`Record::mse_display`].
    pub mse_display: Option<f64>,
    /// See [`Record::rel_mse`].
    pub rel_mse: Option<f64>,
    /// See [`Record::within_tolerance`].
    pub within_tolerance: Option<f64>,
    /// See [`Record::fireflies`].
    pub fireflies: Option<u64>,
}

impl Measured {
    /// The errors of an image against two half-references, which share no samples with it or each other.
    pub fn against(image: &Image, first: &Image, second: &Image) -> Result<Self> {
        Ok(Self {
            mse: Some(metric::cross_mse(image, first, second)?),
            mse_display: Some(metric::cross_mse_display(image, first, second)?),
            rel_mse: Some(metric::cross_rel_mse(image, first, second)?),
            within_tolerance: Some(metric::share_within(image, first, second, TOLERANCE)?),
            fireflies: Some(metric::brighter_pixels(image, first, second, WHITE)?),
        })
    }
}

fn described(settings: &Settings) -> Record {
    let spec = &settings.spec;
    Record {
        schema: SCHEMA,
        experiment: "render".to_string(),
        scene: settings.scene.clone(),
        width: spec.width,
        height: spec.height,
        spp: settings.spp,
        seed: spec.seed,
        estimator: spec.estimator.clone(),
        sampler: spec.sampler.clone(),
        kernel: spec.kernel.clone(),
        precision: spec.precision.clone(),
        max_depth: spec.max_depth,
        roulette: spec.roulette.clone().unwrap_or_default(),
        clamp: spec.clamp.clone().unwrap_or_default(),
        filter: spec.filter.clone().unwrap_or_default(),
        epsilon: spec.epsilon.clone().unwrap_or_default(),
        biased: spec.clamp.is_some() || spec.max_depth.is_some() || spec.filter.is_some() || spec.epsilon.is_some(),
        decomposition: settings.decomposition.clone(),
        strategy: settings.strategy.clone(),
        output: settings.output.clone(),
        threads: settings.threads,
        commit: env!("PATHMARK_COMMIT").to_string(),
        dirty: env!("PATHMARK_DIRTY") == "true",
        started_utc: utc_now(),
        ..Record::default()
    }
}

/// A distance, small ones by their power of ten.
fn distance(value: f64) -> String {
    if value > 0.0 && value < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

/// The row of a run that failed.
pub fn failure(settings: &Settings, error: &str) -> Record {
    Record { error: error.replace('\n', "; "), ..described(settings) }
}

/// The row of another program, with its errors.
pub(super) fn external_row(settings: &Settings, errors: Measured) -> Record {
    described(settings).with_errors(errors)
}

impl Record {
    fn with_errors(mut self, errors: Measured) -> Self {
        self.mse = errors.mse;
        self.rmse = errors.mse.and_then(metric::root);
        self.mse_display = errors.mse_display;
        self.rmse_display = errors.mse_display.and_then(metric::root);
        self.rel_mse = errors.rel_mse;
        self.within_tolerance = errors.within_tolerance;
        self.fireflies = errors.fireflies;
        self
    }

    /// CPU seconds during the makespan, in the program and in the system.
    pub fn cpu_s(&self) -> Option<f64> {
        Some(self.cpu_user_s? + self.cpu_system_s?)
    }

    /// The kernel that rendered, in words: with the precision and the instruction set of its lanes, if it has any.
    pub fn kernel_name(&self) -> String {
        if self.simd.is_empty() {
            self.kernel.clone()
        } else {
            format!("{}, {} {}", self.kernel, self.precision, self.simd)
        }
    }

    /// Adds a doubt.
    pub fn warn(&mut self, warning: &Warning) {
        let separator = if self.warnings.is_empty() { "" } else { ";" };
        self.warnings = format!("{}{separator}{warning}", self.warnings);
    }

    /// The row of a setup before it runs: what it really uses, not what was asked for.
    pub fn of(setup: &Setup) -> Self {
        let described = described(setup.settings());
        let mut record = Self { scene: setup.name().to_string(), scene_hash: setup.hash(), ..described };
        let choice = setup.scene().map(|(_, choice)| choice);
        record.max_depth = choice.and_then(Choice::depth);
        record.roulette = choice.and_then(Choice::roulette).map(|rule| rule.to_string()).unwrap_or_default();
        record.precision = choice.map_or(Precision::F64, Choice::precision).name().to_string();
        record.kernel = choice.map_or(WORKLOAD, Choice::kernel).to_string();
        if let Some(choice) = choice {
            record.biased = choice.is_biased();
            record.clamp = choice.clamp().map(|clamp| clamp.to_string()).unwrap_or_default();
            record.filter = choice.filter().map(Filter::name).unwrap_or_default().to_string();
            record.epsilon = choice.epsilon().map(distance).unwrap_or_default();
            record.kernel_fallback = choice.fallback().to_string();
            record.simd = choice.simd().to_string();
            record.effects = choice.effects().to_string();
            record.accelerator = choice.accelerator().to_string();
        }
        record
    }

    /// The row of a run that was done.
    pub fn new(setup: &Setup, outcome: &Outcome, errors: Measured) -> Self {
        let durations = outcome.trace.durations_s();
        let balance = outcome.trace.balance(outcome.makespan_s, outcome.workers_used as usize);
        let counts = &outcome.counts;
        let mut record = Self::of(setup).with_errors(errors);
        record.spp = outcome.spp;
        record.adaptive = outcome.adaptive;
        record.rounds = Some(outcome.rounds);
        record.estimated_rmse = outcome.film.noise().map(|noise| noise.mse.sqrt());
        record.started_utc.clone_from(&outcome.started_utc);
        if let Some((scene, choice)) = setup.scene() {
            record.box_tests = Some(counts.box_tests);
            // Without a hierarchy every ray is tested against every primitive, and nobody counts.
            let all = counts.rays * scene.owners.len() as u64;
            record.primitive_tests = Some(if choice.is_hierarchical() { counts.primitive_tests } else { all });
        }
        record.build_s = Some(outcome.build_s);
        record.jobs = durations.len();
        record.workers_used = Some(outcome.workers_used);
        record.pilot_s = Some(outcome.pilot_s);
        record.setup_s = Some(outcome.setup_s);
        record.makespan_s = Some(outcome.makespan_s);
        record.merge_s = Some(outcome.merge_s);
        if let Some(cpu) = &outcome.cpu {
            record.cpu_user_s = Some(cpu.user_s);
            record.cpu_system_s = Some(cpu.system_s);
            record.voluntary_switches = Some(cpu.voluntary_switches);
            record.involuntary_switches = Some(cpu.involuntary_switches);
            record.foreign_cpu_s = cpu.foreign_s;
            record.peak_rss_bytes = cpu.peak_rss_bytes;
        }
        if let Some(balance) = &balance {
            record.busy_sum_s = Some(balance.busy_s());
            record.busy_max_s = balance.workers.iter().map(|share| share.busy_s).reduce(f64::max);
            record.gap_sum_s = Some(balance.gap_s());
            record.tail_sum_s = Some(balance.tail_s());
        }
        record.job_min_s = durations.iter().copied().reduce(f64::min);
        record.job_median_s = median(&durations);
        record.job_max_s = durations.iter().copied().reduce(f64::max);
        record.paths = Some(counts.paths);
        record.rays = Some(counts.rays);
        record.escaped = Some(counts.escaped);
        record.truncated = Some(counts.truncated);
        record.invalid_samples = Some(counts.invalid);
        record.variance = Some(outcome.film.mean_variance());
        let image = outcome.film.image();
        record.mean_radiance = Some(image.mean().iter().sum::<f64>() / 3.0);
        record.black_pixels = Some(image.pixels.iter().filter(|pixel| **pixel == [0.0; 3]).count() as u64);
        record.checksum = outcome.checksum.clone().unwrap_or_default();
        record.warnings = outcome.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join(";");
        record
    }
}
