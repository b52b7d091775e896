//! One row of `records.csv`: one repetition of one cell, with everything that is needed to repeat it.

use super::column::columns;
use super::stamp::Stamp;
use super::{Outcome, Settings, Setup, Warning, utc_now};
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::image_io::Image;
use crate::kernel::RenderOptions;
use crate::kernel::workload::WORKLOAD;
use crate::metric;
use crate::scene::{Filter, Scene};
use crate::simd::Precision;
use serde::{Deserialize, Serialize};

/// Version of the columns.
pub const SCHEMA: u32 = 10;

columns! {
    /// A row. A run that failed is a row too: `error` says why, and columns without a measurement are empty.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
    #[serde(deny_unknown_fields)]
    pub struct Record {
        /// Version of the columns.
        pub schema: u32,
        /// Name of the experiment; `render` outside of one.
        pub experiment: String,
        /// The cell's settings in one word; with `repetition`, unique within an experiment.
        pub cell: String,
        /// Name of the scene or workload.
        pub scene: String,
        /// Hash of the scene's definition.
        pub scene_hash: String,
        /// Effect profile of the kernel.
        pub effects: String,
        /// Width of the image in pixels.
        pub width: u32,
        /// Height of the image in pixels.
        pub height: u32,
        /// Samples per pixel.
        pub spp: u32,
        /// Seed of the sampler.
        pub seed: u64,
        /// Name of the estimator.
        pub estimator: String,
        /// Name of the sampler.
        pub sampler: String,
        /// Name of the kernel that rendered, such as `scalar` or `lanes`.
        pub kernel: String,
        /// Why the requested kernel could not render; empty if it did.
        pub kernel_fallback: String,
        /// Floating-point format of the kernel that rendered: `f64` or `f32`.
        pub precision: String,
        /// Instruction set of the lanes; empty for kernels without lanes.
        pub simd: String,
        /// Acceleration structure: `none`, `median` or `sah`.
        pub accelerator: String,
        /// Bounces after which paths were cut; empty if there was no limit.
        pub max_depth: Option<u16>,
        /// Camera rays per sample; empty for one.
        pub camera_rays: Option<u16>,
        /// Russian roulette rule; empty if there was none.
        pub roulette: String,
        /// Whether the noise of each tile determined its number of samples; `spp` is then their mean.
        pub adaptive: bool,
        /// RMSE at which the render was to stop; empty if there was no such goal.
        pub target_error: Option<f64>,
        /// Seconds of rendering after which the render was to stop.
        pub time_limit_s: Option<f64>,
        /// Rounds in which jobs were handed out.
        pub rounds: Option<u32>,
        /// Clamp: `subpixel` or `recursion`, followed by a colon and its limit if that is not 1; empty if there was none.
        pub clamp: String,
        /// Pixel filter; empty if it was the camera's own.
        pub filter: String,
        /// Distance below which hits were dropped; empty if there was none.
        pub epsilon: String,
        /// Whether an option changed what the image converges to.
        pub biased: bool,
        /// Decomposition: how the film was cut into pieces.
        pub decomposition: String,
        /// Name of the scheduling strategy; with several processes, the strategy within each.
        pub strategy: String,
        /// Output: how workers delivered pieces to the film.
        pub output: String,
        /// Requested threads; with several processes, in each.
        pub threads: usize,
        /// Number of processes connected by MPI; empty if there was one process.
        pub ranks: Option<u16>,
        /// Rule by which the processes shared the jobs; empty if there was one process.
        pub rank_rule: String,
        /// MPI library, with its version; empty if there was one process.
        pub mpi: String,
        /// Number of the repetition, from 0.
        pub repetition: u32,
        /// Position in the order in which the sweep ran.
        pub order: u64,
        /// Number of jobs.
        pub jobs: usize,
        /// Workers that did at least one job; empty, like all measurements, if the run failed.
        pub workers_used: Option<u32>,
        /// Seconds to build the kernel and the scene's acceleration structure.
        pub build_s: Option<f64>,
        /// Seconds of `build_s` to compile programs for devices; empty without devices.
        pub device_compile_s: Option<f64>,
        /// Seconds of `build_s` to copy the scene to devices; empty without devices.
        pub device_copy_s: Option<f64>,
        /// Seconds of the pilot that estimates the cost of the pieces, where the strategy needs it.
        pub pilot_s: Option<f64>,
        /// Seconds to create the strategy, including its thread pool if it keeps one.
        pub setup_s: Option<f64>,
        /// Seconds from handing the jobs to the strategy until it returned.
        pub makespan_s: Option<f64>,
        /// Seconds to merge the pieces.
        pub merge_s: Option<f64>,
        /// CPU seconds in the program during the makespan, over all threads.
        pub cpu_user_s: Option<f64>,
        /// CPU seconds in the operating system during the makespan, over all threads.
        pub cpu_system_s: Option<f64>,
        /// Seconds inside jobs, over all workers.
        pub busy_sum_s: Option<f64>,
        /// Seconds inside jobs of the busiest worker.
        pub busy_max_s: Option<f64>,
        /// Seconds that workers spent before their first job and between jobs, over all workers.
        pub gap_sum_s: Option<f64>,
        /// Seconds from each worker's last job to the end of the run, over all workers. Busy time, gaps and tails add up to workers x makespan.
        pub tail_sum_s: Option<f64>,
        /// Seconds of the shortest job.
        pub job_min_s: Option<f64>,
        /// Seconds of the median job.
        pub job_median_s: Option<f64>,
        /// Seconds of the longest job.
        pub job_max_s: Option<f64>,
        /// Context switches because a thread waited.
        pub voluntary_switches: Option<i64>,
        /// Context switches because the system gave the processor to another thread.
        pub involuntary_switches: Option<i64>,
        /// CPU seconds of other programs on the machine during the makespan; up to schema 9 with `steal_s`. Empty where the
        /// system does not report it.
        pub foreign_cpu_s: Option<f64>,
        /// CPU seconds that a virtual machine's host gave to others during the makespan. Empty where the system does not
        /// report it.
        pub steal_s: Option<f64>,
        /// Peak resident memory of the process until the last job returned, without merging and writing of images.
        pub peak_rss_bytes: Option<i64>,
        /// Number of paths: the samples of all pixels.
        pub paths: Option<u64>,
        /// Rays that were traced.
        pub rays: Option<u64>,
        /// Tests of a ray against a box of the acceleration structure.
        pub box_tests: Option<u64>,
        /// Tests of a ray against a primitive.
        pub primitive_tests: Option<u64>,
        /// Rays of paths that left the scene.
        pub escaped: Option<u64>,
        /// Paths cut at the bounce limit.
        pub truncated: Option<u64>,
        /// Samples that were NaN, infinite or negative.
        pub invalid_samples: Option<u64>,
        /// RMSE in linear radiance, estimated from the samples' own variance; too large where samples are stratified.
        pub estimated_rmse: Option<f64>,
        /// Mean squared error in linear radiance, cross form: free of the reference's noise, so it can be negative.
        pub mse: Option<f64>,
        /// Root of `mse`; empty if `mse` is below zero.
        pub rmse: Option<f64>,
        /// Mean squared error of display values (clamped to 0 to 1, gamma 2.2), cross form.
        pub mse_display: Option<f64>,
        /// Root of `mse_display`; empty if `mse_display` is below zero.
        pub rmse_display: Option<f64>,
        /// Mean squared error over the squared reference, cross form.
        pub rel_mse: Option<f64>,
        /// Mean over pixels of the variance of a pixel's mean, estimated from the samples as if they were independent. Where
        /// subpixels or a sampler spread the samples evenly, the true error is smaller.
        pub variance: Option<f64>,
        /// Mean squared error, cross form, over the pixels of the object that the experiment names; NaN if the object fills no pixel.
        pub object_mse: Option<f64>,
        /// Share of pixels whose display value is within 0.05 of the reference's in every channel.
        pub within_tolerance: Option<f64>,
        /// Pixels that are brighter than the reference by more than 1, the display's white, in any channel.
        pub fireflies: Option<u64>,
        /// Mean radiance over pixels and channels.
        pub mean_radiance: Option<f64>,
        /// Pixels in which every channel is 0.
        pub black_pixels: Option<u64>,
        /// Seconds to write the image; empty if it was not kept.
        pub image_write_s: Option<f64>,
        /// Checksum of the film; empty if the sampler draws different random numbers in each run.
        pub checksum: String,
        /// Warnings, separated by semicolons; `pathmark list warnings` explains them.
        pub warnings: String,
        /// Why the run failed; empty if it did not.
        pub error: String,
        /// Commit of the program's sources.
        pub commit: String,
        /// Whether the sources had uncommitted changes.
        pub dirty: bool,
        /// When the run started, in UTC; empty if the system's clock shows no date from 1970 to 9999.
        pub started_utc: String,
    }
}

/// See [`Record::within_tolerance`].
const TOLERANCE: f64 = 0.05;

/// See [`Record::fireflies`].
const WHITE: f64 = 1.0;

/// The errors of an image, if there was a reference.
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
        adaptive: settings.adaptive,
        seed: spec.seed,
        estimator: spec.estimator.clone(),
        sampler: spec.sampler.clone(),
        kernel: spec.kernel.clone(),
        precision: spec.precision.clone(),
        max_depth: spec.max_depth,
        camera_rays: spec.camera_rays,
        roulette: spec.roulette.clone().unwrap_or_default(),
        clamp: spec.clamp.clone().unwrap_or_default(),
        filter: spec.filter.clone().unwrap_or_default(),
        epsilon: spec.epsilon.clone().unwrap_or_default(),
        biased: spec.clamp.is_some() || spec.max_depth.is_some() || spec.filter.is_some() || spec.epsilon.is_some(),
        decomposition: settings.decomposition.clone(),
        strategy: settings.strategy.clone(),
        output: settings.output.clone(),
        threads: settings.threads,
        ranks: settings.ranks,
        rank_rule: settings.rank_rule.clone().unwrap_or_default(),
        commit: Stamp::of_program().commit.to_string(),
        dirty: Stamp::of_program().is_dirty,
        started_utc: utc_now(),
        ..Record::default()
    }
}

/// A distance as text; small ones by their power of ten.
fn distance(value: f64) -> String {
    if value > 0.0 && value < 1e-3 { format!("{value:e}") } else { value.to_string() }
}

/// The row of a failed run.
pub fn failure(settings: &Settings, error: &str) -> Record {
    Record { error: error.replace('\n', "; "), ..described(settings) }
}

/// The row of another program, with its errors.
pub(super) fn external_row(settings: &Settings, scene: &Scene, errors: Measured) -> Record {
    Record { scene: scene.name.clone(), scene_hash: scene.hash.clone(), ..described(settings).with_errors(errors) }
}

impl Record {
    /// The row with the errors of its image.
    #[must_use]
    pub fn with_errors(mut self, errors: Measured) -> Self {
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

    /// Seconds that its samples took: the makespan, plus the pilot if it distributed the samples.
    pub fn rendering_s(&self) -> Option<f64> {
        let pilot_s = if self.adaptive { self.pilot_s? } else { 0.0 };
        Some(self.makespan_s? + pilot_s)
    }

    /// The kernel that rendered, in words: with the precision and the instruction set of its lanes, if it has any.
    pub fn kernel_name(&self) -> String {
        // Only lanes and devices have another precision than double.
        match (self.simd.as_str(), self.precision.as_str()) {
            ("", double) if double == Precision::F64.name() => self.kernel.clone(),
            ("", precision) => format!("{}, {precision}", self.kernel),
            (simd, precision) => format!("{}, {precision} {simd}", self.kernel),
        }
    }

    /// Adds a warning.
    pub fn warn(&mut self, warning: &Warning) {
        let separator = if self.warnings.is_empty() { "" } else { ";" };
        self.warnings = format!("{}{separator}{warning}", self.warnings);
    }

    /// The row of a setup before it runs, with the values that it really uses, not the requested ones.
    pub fn of(setup: &Setup) -> Self {
        let described = described(setup.settings());
        let mut record = Self { scene: setup.name().to_string(), scene_hash: setup.hash(), ..described };
        let choice = setup.scene().map(|(_, choice)| choice);
        record.max_depth = choice.and_then(RenderOptions::depth);
        record.camera_rays = choice.map(RenderOptions::camera_rays).filter(|rays| *rays > 1);
        record.roulette = choice.and_then(RenderOptions::roulette).map(|rule| rule.to_string()).unwrap_or_default();
        record.precision = choice.map_or(Precision::F64, RenderOptions::precision).name().to_string();
        record.kernel = choice.map_or(WORKLOAD, RenderOptions::kernel).to_string();
        if let Some(choice) = choice {
            record.estimator = choice.estimator().name.to_string();
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

    /// The row of a finished run.
    pub fn new(setup: &Setup, outcome: &Outcome, errors: Measured) -> Self {
        let durations = outcome.trace.durations_s();
        let balance = outcome.trace.balance(outcome.makespan_s, outcome.workers_used as usize);
        let (counts, mut record) = (&outcome.counts, Self::of(setup).with_errors(errors));
        record.spp = outcome.spp;
        record.rounds = Some(outcome.rounds);
        record.estimated_rmse = outcome.film.noise().map(|noise| noise.mse.sqrt());
        record.started_utc.clone_from(&outcome.started_utc);
        if let Some((scene, choice)) = setup.scene() {
            record.box_tests = Some(counts.box_tests);
            // Without a hierarchy every ray is tested against every primitive, and no test is counted.
            let all = counts.rays * scene.owners.len() as u64;
            record.primitive_tests = Some(if choice.is_hierarchical() { counts.primitive_tests } else { all });
        }
        record.build_s = Some(outcome.build_s);
        record.device_compile_s = outcome.device.map(|device| device.compile_s);
        record.device_copy_s = outcome.device.map(|device| device.copy_s);
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
            record.steal_s = cpu.steal_s;
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
        record.warnings = outcome.warned();
        record
    }
}
