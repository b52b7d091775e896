//! Bursts: many short parallel regions with gaps between them, as in a program that is parallel in its inner loops.
//!
//! Every region finds its workers waiting. A pool may let them sleep, and pay for waking them, or let them spin, and pay
//! with the processors' time. So a turn measures both sides: the time from the hand-over of a region to the first job on
//! another thread (wake latency), and the processor time that the process uses in the gaps. There the caller sleeps and
//! nobody has work.
//!
//! In some pools the caller works, too, and may have done everything before another thread wakes. Such a region counts with
//! its whole length, so the latency of these pools is a lower bound.
//!
//! Only one pool exists at a time: workers that spin would slow the others. Threads start before the first region, which is
//! not counted.

use super::calibration::Counted;
use super::usage::cpu_s;
use crate::analysis::quantile::{median, quantile};
use crate::error::{Error, Result};
use crate::lab::Lab;
use crate::strategy::{Config, StrategyError, Workers};
use serde::{Deserialize, Serialize};
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The regions of a turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bursts {
    pub threads: NonZeroUsize,
    pub regions: u32,
    /// Jobs of a region.
    pub jobs: usize,
    pub job: Duration,
    /// The time that the caller sleeps before each region; the system may let it sleep longer.
    pub gap: Duration,
}

/// The measurements of a strategy in one turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BurstRow {
    /// Process, round within it, and place in the round, each from 0.
    pub process: u32,
    pub round: u32,
    pub place: u32,
    pub strategy: String,
    pub threads: usize,
    pub regions: u32,
    pub jobs: usize,
    /// Seconds of a job and of a gap, as requested.
    pub job_s: f64,
    pub gap_s: f64,
    /// Seconds of a gap, as they were: their mean.
    pub slept_s: f64,
    /// Seconds from the hand-over of a region to the first job on another thread than the caller's: median and 95th percentile.
    pub wake_s: f64,
    pub wake_p95_s: f64,
    /// Median seconds of a region.
    pub region_s: f64,
    /// Processor seconds of this process in each second of a gap. Empty without gaps, or if the system does not report them.
    pub idle_processors: Option<f64>,
    /// Threads that the strategy starts in each region: 0 for pools.
    pub started: f64,
}

impl BurstRow {
    /// Seconds of a region whose jobs start at once and are shared as evenly as whole jobs can be.
    pub fn ideal_s(&self) -> f64 {
        self.jobs.div_ceil(self.threads) as f64 * self.job_s
    }
}

/// Work of a known length.
#[derive(Debug, Clone, Copy)]
pub struct Spin {
    steps_per_s: f64,
}

/// Steps of a measured block, about a millisecond.
const BLOCK: u64 = 500_000;
/// Blocks, of which the fastest counts: the others were interrupted.
const BLOCKS: u32 = 15;

fn spin(steps: u64) {
    let mut state = steps;
    for _ in 0..steps {
        state = black_box(state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(1));
    }
}

impl Spin {
    /// Measures how many steps a second has.
    pub fn calibrate() -> Self {
        let block = |_| {
            let start = Instant::now();
            spin(BLOCK);
            start.elapsed().as_secs_f64()
        };
        let seconds = (0..BLOCKS).map(block).fold(f64::INFINITY, f64::min);
        Self { steps_per_s: BLOCK as f64 / seconds.max(1e-9) }
    }

    fn steps(self, length: Duration) -> u64 {
        (self.steps_per_s * length.as_secs_f64()).round() as u64
    }
}

/// Whether the strategy keeps its threads between two runs. Found by trying, so it holds for strategies of other programs.
pub fn keeps_threads(lab: &Lab, strategy: &str, threads: NonZeroUsize) -> Result<bool> {
    let few = Bursts { threads, regions: 1, jobs: threads.get(), job: Duration::ZERO, gap: Duration::ZERO };
    let is_parallel = lab.strategy_named(strategy)?.0.workers == Workers::Threads;
    Ok(is_parallel && run_bursts(lab, strategy, Spin { steps_per_s: 0.0 }, few)?.started == 0.0)
}

/// Runs the regions of a turn on a strategy that is made for it.
pub fn run_bursts(lab: &Lab, strategy: &str, work: Spin, bursts: Bursts) -> Result<BurstRow> {
    let Bursts { threads, regions, jobs, job, gap } = bursts;
    let (entry, parameter) = lab.strategy_named(strategy)?;
    let counted = Arc::new(Counted::default());
    let failed = |e: StrategyError| Error::system("running strategy", strategy, std::io::Error::other(e));
    let config = Config { parameter, spawner: Arc::clone(&counted) as _, ..Config::new(threads) };
    let mut pool = entry.build(config).map_err(failed)?;
    let steps = work.steps(job);
    let mut region = || -> Result<[f64; 2]> {
        let first = Arc::new(AtomicU64::new(u64::MAX));
        let (told, caller) = (Arc::clone(&first), thread::current().id());
        let start = Instant::now();
        let job = move |_| {
            let now = start.elapsed().as_nanos() as u64;
            // Only the first jobs write, so that the others share the line.
            if now < told.load(Ordering::Relaxed) && thread::current().id() != caller {
                told.fetch_min(now, Ordering::Relaxed);
            }
            spin(steps);
        };
        pool.run(jobs, Arc::new(job)).map_err(failed)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok([seconds.min(1e-9 * first.load(Ordering::Relaxed) as f64), seconds])
    };
    region()?;
    let before = counted.number();
    let (mut wakes, mut lengths) = (Vec::new(), Vec::new());
    let (mut slept_s, mut idle_s) = (0.0, Some(0.0));
    for _ in 0..regions {
        let (start, used) = (Instant::now(), cpu_s());
        if !gap.is_zero() {
            thread::sleep(gap);
        }
        idle_s = idle_s.zip(used.zip(cpu_s())).map(|(sum, (before, after))| sum + (after - before));
        slept_s += start.elapsed().as_secs_f64();
        let [wake_s, region_s] = region()?;
        wakes.push(wake_s);
        lengths.push(region_s);
    }
    Ok(BurstRow {
        process: 0,
        round: 0,
        place: 0,
        strategy: strategy.to_string(),
        threads: threads.get(),
        regions,
        jobs,
        job_s: job.as_secs_f64(),
        gap_s: gap.as_secs_f64(),
        slept_s: slept_s / f64::from(regions),
        wake_s: median(&wakes).unwrap_or_default(),
        wake_p95_s: quantile(&wakes, 0.95).unwrap_or_default(),
        region_s: median(&lengths).unwrap_or_default(),
        idle_processors: idle_s.filter(|_| !gap.is_zero()).map(|idle_s| idle_s / slept_s),
        started: (counted.number() - before) as f64 / f64::from(regions),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bursts(jobs: usize) -> Bursts {
        let threads = NonZeroUsize::new(2).unwrap();
        Bursts { threads, regions: 3, jobs, job: Duration::ZERO, gap: Duration::from_nanos(1) }
    }

    #[test]
    fn pools_are_told_from_strategies_that_start_threads() {
        let lab = Lab::built_in();
        let threads = NonZeroUsize::new(2).unwrap();
        for (name, keeps) in
            [("rayon", true), ("fixed-pool", true), ("chili", true), ("shared-counter", false), ("serial", false)]
        {
            assert_eq!(keeps_threads(&lab, name, threads).unwrap(), keeps, "{name}");
        }
        // Two threads for each region, but never more than there are jobs.
        let started =
            |jobs| run_bursts(&lab, "shared-counter", Spin { steps_per_s: 0.0 }, bursts(jobs)).unwrap().started;
        assert_eq!([started(5), started(1)], [2.0, 1.0]);
    }

    /// Only the order of events is certain: the first job starts before its region ends. A caller that works alone wakes nobody.
    #[test]
    fn a_region_contains_its_wake() {
        let row = run_bursts(&Lab::built_in(), "rayon", Spin::calibrate(), bursts(4)).unwrap();
        assert!(0.0 < row.wake_s && row.wake_s <= row.wake_p95_s && row.wake_s < row.region_s, "{row:?}");
        assert!(row.slept_s > 0.0 && row.idle_processors.is_some(), "{row:?}");
        let alone = run_bursts(&Lab::built_in(), "serial", Spin::calibrate(), bursts(4)).unwrap();
        assert_eq!(alone.wake_s, alone.region_s);
    }

    #[test]
    fn the_ideal_shares_whole_jobs() {
        let row = run_bursts(&Lab::built_in(), "rayon", Spin { steps_per_s: 0.0 }, bursts(5)).unwrap();
        assert_eq!(BurstRow { job_s: 2.0, ..row }.ideal_s(), 6.0);
    }
}
