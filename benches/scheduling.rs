//! `cargo bench --bench scheduling`: every strategy on one fixed small render and on empty jobs.
//!
//! Group `scheduling` renders cornell at 192x144, 4 spp, in tiles of 8x8, with 1, 2 and 4 threads, in samples per second.
//! Each run has a serial run of the same tiles beside it, and the speedups at the end come from these adjacent pairs, in
//! several processes. Group `empty-jobs` hands out jobs that do nothing. Group `seam` compares strategies with their bare
//! mechanisms, which shows the overhead of the interface between scheduling and work for each job
//! (`cargo bench --bench scheduling -- seam`). Group `trace` compares a measured render with the same render unmeasured,
//! which shows the overhead of recording which worker ran which job when.

mod bare;
mod bench;
mod pairs;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use pairs::Speedups;
use pathmark::film::{Decomposition, TileBuffer};
use pathmark::kernel::{Kernel, Spec, build};
use pathmark::measure::{Settings, Setup};
use pathmark::strategy::{Config, Entry, Job, STRATEGIES, Strategy, Workers, find};
use std::hint::black_box;
use std::num::NonZeroUsize;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

const THREADS: [usize; 3] = [1, 2, 4];
const SPP: u32 = 4;
const EMPTY_JOBS: usize = 10_000;
/// For strategies with a thread for each job: ten thousand threads would measure the system's limits.
const EMPTY_JOBS_PER_THREAD: usize = 500;

/// Returns the number of jobs and the job. A job renders a tile into its own buffer and discards it; jobs share only
/// the kernel.
fn render_job(spec: &Spec) -> (usize, Job) {
    let scene = Arc::new(pathmark::scene::load("cornell").expect("cornell is embedded"));
    let kernel: Arc<dyn Kernel> = Arc::from(build(&scene, spec).expect("the default names exist"));
    let decomposition = Decomposition::parse("tiles:8x8").expect("tiles can be cut");
    let plan = decomposition.plan(spec.width, spec.height, &(0..SPP));
    let jobs = plan.len();
    let job = move |index: usize| {
        let piece = &plan.pieces()[index];
        let mut tile = TileBuffer::new(piece.bounds);
        black_box(kernel.render(piece, &mut tile));
        black_box(&tile);
    };
    (jobs, Arc::new(job))
}

/// Returns the thread counts that are useful for a strategy.
fn thread_counts(workers: Workers) -> &'static [usize] {
    match workers {
        Workers::Threads => &THREADS,
        Workers::Caller | Workers::PerJob => &[1],
    }
}

/// Returns the parameter in a case's name: the thread count, or `per-job` for a thread for each job.
fn threads_label(workers: Workers, threads: usize) -> String {
    if workers == Workers::PerJob { "per-job".to_string() } else { threads.to_string() }
}

fn strategy(entry: &Entry, threads: usize) -> Box<dyn Strategy> {
    let config = Config::new(NonZeroUsize::new(threads).expect("thread counts are positive"));
    entry.build(config).expect("threads can be started")
}

/// The image of the cases: a serial run takes 10 to 50 ms.
fn rendered() -> (usize, Job, u64) {
    let spec = Spec { width: 192, height: 144, ..Spec::default() };
    let (jobs, job) = render_job(&spec);
    (jobs, job, u64::from(spec.width) * u64::from(spec.height) * u64::from(SPP))
}

/// The cases, each with its strategy and its number of threads.
fn cases() -> impl Iterator<Item = (String, &'static Entry, usize)> {
    let of_entry = |entry: &'static Entry| {
        let case =
            move |threads: &usize| (pairs::name(entry.name, &threads_label(entry.workers, *threads)), entry, *threads);
        thread_counts(entry.workers).iter().map(case)
    };
    STRATEGIES.iter().flat_map(of_entry)
}

/// Runs of a strategy, each beside a serial one.
struct Beside {
    jobs: usize,
    job: Job,
    strategy: Box<dyn Strategy>,
    serial: Box<dyn Strategy>,
}

impl Beside {
    fn new(entry: &Entry, threads: usize, jobs: usize, job: &Job) -> Self {
        let serial = find("serial").expect("there is a serial strategy");
        Self { jobs, job: Arc::clone(job), strategy: strategy(entry, threads), serial: strategy(serial, 1) }
    }

    fn run(&mut self, times: u64) -> (Duration, Vec<f64>) {
        let Self { jobs, job, strategy, serial } = self;
        let run =
            |strategy: &mut Box<dyn Strategy>| strategy.run(*jobs, Arc::clone(job)).expect("threads can be started");
        pairs::beside(times, &mut || run(strategy), &mut || run(serial))
    }
}

/// The pairs of a case in a further process.
fn pairs_of(case: &str, times: u64) -> Option<Vec<f64>> {
    static RENDERED: LazyLock<(usize, Job, u64)> = LazyLock::new(rendered);
    let (_, entry, threads) = cases().find(|(name, ..)| name == case)?;
    let (jobs, job, _) = &*RENDERED;
    let mut beside = Beside::new(entry, threads, *jobs, job);
    // The first run of a process is slower than the rest.
    beside.run(1);
    Some(beside.run(times).1)
}

fn scheduling(criterion: &mut Criterion, speedups: &mut Speedups) {
    let (jobs, job, samples) = rendered();
    let mut group = criterion.benchmark_group("scheduling");
    group.sample_size(10).sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(samples));
    group.warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
    for (name, entry, threads) in cases() {
        let mut beside = Beside::new(entry, threads, jobs, &job);
        group.bench_function(BenchmarkId::new(entry.name, threads_label(entry.workers, threads)), |bencher| {
            bencher.iter_custom(|times| {
                let (sum, ratios) = beside.run(times);
                speedups.add(&name, &ratios);
                sum
            });
        });
    }
    group.finish();
}

fn empty_jobs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("empty-jobs");
    group.sample_size(10).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(500));
    let job: Job = Arc::new(|index| {
        black_box(index);
    });
    for entry in STRATEGIES {
        let jobs = if entry.workers == Workers::PerJob { EMPTY_JOBS_PER_THREAD } else { EMPTY_JOBS };
        group.throughput(Throughput::Elements(jobs as u64));
        for &threads in thread_counts(entry.workers).iter().filter(|threads| **threads <= 2) {
            let mut strategy = strategy(entry, threads);
            group.bench_function(BenchmarkId::new(entry.name, threads_label(entry.workers, threads)), |bencher| {
                bencher.iter(|| strategy.run(jobs, Arc::clone(&job)).expect("threads can be started"));
            });
        }
    }
    group.finish();
}

fn seam(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("seam");
    group.sample_size(20).warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(600));
    group.throughput(Throughput::Elements(EMPTY_JOBS as u64));
    let job: Job = Arc::new(bare::empty);
    for (name, bare) in bare::PAIRS {
        let entry = find(name).expect("every mechanism has its strategy");
        for &threads in thread_counts(entry.workers).iter().filter(|threads| **threads <= 2) {
            let mut bare = bare(threads);
            group.bench_function(BenchmarkId::new(format!("{name}-bare"), threads), |bencher| {
                bencher.iter(|| bare(EMPTY_JOBS));
            });
            let mut strategy = strategy(entry, threads);
            group.bench_function(BenchmarkId::new(name, threads), |bencher| {
                bencher.iter(|| strategy.run(EMPTY_JOBS, Arc::clone(&job)).expect("threads can be started"));
            });
        }
    }
    group.finish();
}

/// Compares the same pieces in a bare loop and through `measure`. Both are serial, so only the measuring differs.
fn trace(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("trace");
    group.sample_size(20).sampling_mode(SamplingMode::Flat);
    group.warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(700));
    // The smallest possible jobs, so that their overhead is as large a part of the time as possible.
    let spec = Spec { width: 64, height: 48, estimator: "bsdf".to_string(), ..Spec::default() };
    let pieces = "tiles:1x1";
    let settings = Settings {
        spp: 1,
        spec: spec.clone(),
        decomposition: pieces.to_string(),
        strategy: "serial".to_string(),
        ..Settings::default()
    };
    let scene = Arc::new(pathmark::scene::load("cornell").expect("cornell is embedded"));
    let kernel = build(&scene, &spec).expect("the default names exist");
    let plan = Decomposition::parse(pieces).expect("tiles can be cut").plan(spec.width, spec.height, &(0..1));
    group.throughput(Throughput::Elements(plan.len() as u64));
    let mut tiles: Vec<TileBuffer> = plan.pieces().iter().map(|piece| TileBuffer::new(piece.bounds)).collect();
    group.bench_function(BenchmarkId::new("bare", pieces), |bencher| {
        bencher.iter(|| {
            for (piece, tile) in plan.pieces().iter().zip(&mut tiles) {
                black_box(kernel.render(piece, tile));
            }
        });
    });
    let setup = Setup::prepare(settings).expect("these settings exist");
    group.bench_function(BenchmarkId::new("measured", pieces), |bencher| {
        bencher.iter_custom(|rounds| {
            let makespan_s = (0..rounds).map(|_| setup.run(None).expect("a render ends").makespan_s);
            Duration::from_secs_f64(makespan_s.sum())
        });
    });
    group.finish();
}

fn main() {
    let units = [("scheduling", "sample"), ("empty-jobs", "job"), ("seam", "job"), ("trace", "job")];
    if pairs::is_further_process(pairs_of) {
        return;
    }
    let mut speedups = Speedups::default();
    bench::run(&units, |criterion| {
        scheduling(criterion, &mut speedups);
        empty_jobs(criterion);
        seam(criterion);
        trace(criterion);
    });
    speedups.finish();
}
