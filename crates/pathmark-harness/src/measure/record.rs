//! One row of `records.csv`: one repetition of one cell, with everything that is needed to repeat it.

use super::column::columns;
use super::provenance::Stamp;
use super::{Column, ImageKey, Outcome, ScheduleKey, Settings, Setup, Warning, utc_now};
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::image_io::Image;
use crate::lab::SERIAL;
use crate::metric;
use crate::scene::Scene;
use crate::settings::{Asked, settings_list};
use crate::simd::Precision;
use serde::{Deserialize, Serialize};

/// Version of the columns.
pub const SCHEMA: u32 = 14;

settings_list!(columns {
    /// A row. A run that failed is a row too: `error` says why, and columns without a measurement are empty.
    #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
    #[serde(deny_unknown_fields)]
    pub struct Record {
        /// Version of the columns.
        pub schema: u32,
        /// Name of the experiment; `render` outside of one.
        pub experiment: String,
        /// The cell's settings in one word; with `repetition` and `pair`, unique within an experiment.
        pub cell: String,
    }
    settings
    {
        /// RMSE at which the render was to stop; empty if there was no such goal.
        pub target_error: Option<f64>,
        /// Rounds in which jobs were handed out.
        pub rounds: Option<u32>,
        /// Whether an option changed what the image converges to.
        pub biased: bool,
        /// MPI library, with its version; empty if there was one process.
        pub mpi: String,
        /// Number of the repetition, from 0. Runs that are compared in adjacent pairs are repeated within a process, so this
        /// is the number of the process.
        pub repetition: u32,
        /// Number of the pair within the process, from 0; empty if each run had a process of its own.
        pub pair: Option<u32>,
        /// Place in the pair, from 0: how many of the compared cells ran before this one.
        pub place: Option<u32>,
        /// Runs that followed each other in this place of the pair. Runs of less than 7.5 ms, serial ones of less than 3 ms, are
        /// repeated; times and counters are then means over them. Empty outside of pairs.
        pub runs: Option<u32>,
        /// Position in the order in which the sweep ran.
        pub run_order: u64,
        /// Number of jobs.
        pub jobs: usize,
        /// Workers that did at least one job; empty, like all measurements, if the run failed.
        pub workers_used: Option<u32>,
        /// Seconds to build the kernel and the scene's acceleration structure.
        pub kernel_build_s: Option<f64>,
        /// Seconds of `kernel_build_s` to compile programs for devices; empty without devices.
        pub device_compile_s: Option<f64>,
        /// Seconds of `kernel_build_s` to copy the scene to devices; empty without devices.
        pub device_copy_s: Option<f64>,
        /// Seconds of the pilot that estimates the cost of the pieces, where the strategy needs it.
        pub pilot_s: Option<f64>,
        /// Seconds to create the strategy, including its thread pool if it keeps one.
        pub strategy_setup_s: Option<f64>,
        /// Seconds from handing the jobs to the strategy until it returned.
        pub makespan_s: Option<f64>,
        /// Seconds to merge the pieces.
        pub merge_s: Option<f64>,
        /// Seconds from handing over the jobs until one process has the image and its brightest channel: makespan, merge,
        /// gathering from other processes, and the search for the maximum that an exposure needs. With several processes
        /// from the barrier before the first job.
        pub time_to_image_s: Option<f64>,
        /// CPU seconds in the program during the makespan, over all threads.
        pub cpu_user_s: Option<f64>,
        /// CPU seconds in the operating system during the makespan, over all threads.
        pub cpu_system_s: Option<f64>,
        /// Seconds inside jobs, over all workers.
        pub busy_sum_s: Option<f64>,
        /// Seconds inside jobs of the busiest worker.
        pub busy_max_s: Option<f64>,
        /// Seconds that workers spent before their first job and between jobs, over all workers.
        pub idle_between_jobs_s: Option<f64>,
        /// Seconds from handing over the jobs to each worker's first job, over all workers; part of `idle_between_jobs_s`.
        pub idle_before_first_job_s: Option<f64>,
        /// Seconds from each worker's last job to the end of the run, over all workers. Busy time, gaps and tails add up to workers x makespan.
        pub idle_tail_s: Option<f64>,
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
        pub other_cpu_s: Option<f64>,
        /// CPU seconds that a virtual machine's host gave to others during the makespan. Empty where the system does not
        /// report it.
        pub steal_s: Option<f64>,
        /// Times that a worker began a job on another processor than its job before. Empty where the system does not report
        /// it, and for several processes.
        pub migrations: Option<u64>,
        /// Mean clock of the processors that the program may use, before the run, as the system reports it; empty where it does
        /// not.
        pub clock_start_mhz: Option<f64>,
        /// Mean clock of these processors after the run.
        pub clock_end_mhz: Option<f64>,
        /// Cycles of the processors in this program during the makespan; like all counters empty without the setting
        /// `counters`, and where the system does not grant it.
        pub cycles: Option<u64>,
        /// Instructions in this program during the makespan.
        pub instructions: Option<u64>,
        /// Misses of the last cache in this program during the makespan.
        pub cache_misses: Option<u64>,
        /// Mispredicted branches in this program during the makespan.
        pub branch_misses: Option<u64>,
        /// Peak resident memory of the process until the last job returned, without merging and writing of images.
        pub peak_rss_bytes: Option<i64>,
        /// Number of paths: the samples of all pixels.
        pub samples: Option<u64>,
        /// Rays that were traced.
        pub rays: Option<u64>,
        /// Tests of a ray against a box of the acceleration structure.
        pub box_tests: Option<u64>,
        /// Tests of a ray against a primitive.
        pub primitive_tests: Option<u64>,
        /// Rays of paths that left the scene.
        pub escaped_rays: Option<u64>,
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
        /// Largest finite channel of any pixel, by which `--auto-exposure` divides; several processes find it together.
        pub max_radiance: Option<f64>,
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
});

/// See [`Record::within_tolerance`].
const TOLERANCE: f64 = 0.05;

/// See [`Record::fireflies`].
const WHITE: f64 = 1.0;

/// The row of an image and a schedule, without measurements.
fn described(image: ImageKey, schedule: ScheduleKey) -> Record {
    Record {
        schema: SCHEMA,
        experiment: "render".to_string(),
        biased: image.is_biased(),
        commit: Stamp::of_program().commit.to_string(),
        dirty: Stamp::of_program().is_dirty,
        started_utc: utc_now(),
        ..Record::of_keys(image, schedule)
    }
}

/// The row of what was asked for.
fn asked(settings: &Settings) -> Record {
    described(ImageKey::of(settings), ScheduleKey::of(settings))
}

/// The row of a failed run.
pub fn failure(settings: &Settings, error: &str) -> Record {
    Record { error: error.replace('\n', "; "), ..asked(settings) }
}

/// The row of another program.
pub(super) fn external_row(settings: &Settings, scene: &Scene) -> Record {
    Record { scene: scene.name.clone(), scene_hash: scene.hash.clone(), ..asked(settings) }
}

impl Record {
    /// The row with the errors of its image against two half-references, which share no samples with it or each other.
    pub fn with_errors(mut self, image: &Image, [first, second]: &[Image; 2]) -> Result<Self> {
        let mse = metric::cross_mse(image, first, second)?;
        let mse_display = metric::cross_mse_display(image, first, second)?;
        (self.mse, self.rmse) = (Some(mse), metric::root(mse));
        (self.mse_display, self.rmse_display) = (Some(mse_display), metric::root(mse_display));
        self.rel_mse = Some(metric::cross_rel_mse(image, first, second)?);
        self.within_tolerance = Some(metric::share_within(image, first, second, TOLERANCE)?);
        self.fireflies = Some(metric::brighter_pixels(image, first, second, WHITE)?);
        Ok(self)
    }

    /// The row with the errors of another row of the same image.
    #[must_use]
    pub fn with_errors_of(self, other: &Self) -> Self {
        Self {
            mse: other.mse,
            rmse: other.rmse,
            mse_display: other.mse_display,
            rmse_display: other.rmse_display,
            rel_mse: other.rel_mse,
            within_tolerance: other.within_tolerance,
            fireflies: other.fireflies,
            object_mse: other.object_mse,
            ..self
        }
    }

    /// Whether one worker ran one job after the other.
    pub fn is_serial(&self) -> bool {
        self.strategy == SERIAL && self.ranks.is_none()
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
        let threads = setup.settings().threads;
        Self { threads, ..described(setup.image_key(), setup.schedule_key()) }
    }

    /// The row of a finished run.
    pub fn new(setup: &Setup, outcome: &Outcome) -> Self {
        let durations = outcome.trace.durations_s();
        let balance = outcome.trace.balance(outcome.makespan_s, outcome.workers_used as usize);
        let (counts, mut record) = (&outcome.counts, Self::of(setup));
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
        record.kernel_build_s = Some(outcome.build_s);
        record.device_compile_s = outcome.device.map(|device| device.compile_s);
        record.device_copy_s = outcome.device.map(|device| device.copy_s);
        record.jobs = durations.len();
        record.workers_used = Some(outcome.workers_used);
        record.pilot_s = Some(outcome.pilot_s);
        record.strategy_setup_s = Some(outcome.setup_s);
        record.makespan_s = Some(outcome.makespan_s);
        record.merge_s = Some(outcome.merge_s);
        record.time_to_image_s = Some(outcome.time_to_image_s);
        record.max_radiance = Some(outcome.brightest);
        if let Some(cpu) = &outcome.cpu {
            record.cpu_user_s = Some(cpu.user_s);
            record.cpu_system_s = Some(cpu.system_s);
            record.voluntary_switches = Some(cpu.voluntary_switches);
            record.involuntary_switches = Some(cpu.involuntary_switches);
            record.other_cpu_s = cpu.foreign_s;
            record.steal_s = cpu.steal_s;
            record.peak_rss_bytes = cpu.peak_rss_bytes;
        }
        let observed = &outcome.observed;
        record.migrations = observed.migrations;
        [record.clock_start_mhz, record.clock_end_mhz] = observed.clock_mhz;
        [record.cycles, record.instructions, record.cache_misses, record.branch_misses] = observed.counted;
        if let Some(balance) = &balance {
            record.busy_sum_s = Some(balance.busy_s());
            record.busy_max_s = balance.workers.iter().map(|share| share.busy_s).reduce(f64::max);
            record.idle_between_jobs_s = Some(balance.gap_s());
            record.idle_before_first_job_s = Some(outcome.trace.starting_s());
            record.idle_tail_s = Some(balance.tail_s());
        }
        record.job_min_s = durations.iter().copied().reduce(f64::min);
        record.job_median_s = median(&durations);
        record.job_max_s = durations.iter().copied().reduce(f64::max);
        record.samples = Some(counts.paths);
        record.rays = Some(counts.rays);
        record.escaped_rays = Some(counts.escaped);
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
