//! A run: jobs handed to a strategy, once or in several rounds, timed and verified.

use super::counters::Counters;
use super::history::{History, InvalidSample, first_invalid};
use super::hybrid::{PieceClaims, Shared};
use super::ledger::{Ledger, migrations};
use super::observed::{Before, Observed};
use super::output::{Delivery, Output};
use super::provenance::Provenance;
use super::usage::{FOREIGN_SHARE, Usage};
use super::{JobSpan, Setup, Trace, Warning, available_threads, utc_now};
use crate::error::{Error, Result};
use crate::film::{Film, Plan, Reserve, Sections};
use crate::film_file::FilmKey;
use crate::kernel::{Counts, DeviceCosts, Kernel};
use crate::strategy::Strategy;
use std::cell::Cell;
use std::ops::Range;
use std::slice::from_ref;
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Seconds of a run below which the start of threads and single interruptions weigh more than the schedule. A serial run
/// starts no thread.
pub(super) fn shortest_s(is_serial: bool) -> f64 {
    if is_serial { 2e-3 } else { 5e-3 }
}

/// The system counts in hundredths of a second, once for each processor: less than this may be rounding error.
const FOREIGN_LEAST_S: f64 = 0.03;

/// A function that another thread calls now and then with the number of jobs done.
pub type Watch<'a> = Option<&'a (dyn Fn(u64) + Sync)>;

pub struct Outcome {
    pub film: Film,
    /// Samples per pixel; their mean if the run was adaptive.
    pub spp: u32,
    pub rounds: u32,
    /// The pieces, in the order in which they were handed out.
    pub plan: Arc<Plan>,
    /// Which worker ran which job when. The time between rounds is left out.
    pub trace: Trace,
    pub job_counts: Vec<Counts>,
    /// The counts of the film's paths, including those that earlier processes rendered.
    pub counts: Counts,
    /// The first samples that were NaN, infinite or negative: round by round, by row, column and number.
    pub invalid: Vec<InvalidSample>,
    /// Threads that ran at least one job.
    pub workers_used: u32,
    /// Seconds to build the kernel and the scene's acceleration structure; once for all runs of a setup.
    pub build_s: f64,
    /// The part of it that devices took, if there were any.
    pub device: Option<DeviceCosts>,
    /// Seconds to estimate the costs of the pieces, if their order depends on them.
    pub pilot_s: f64,
    pub setup_s: f64,
    /// Seconds from handing over the jobs until all were done, over all rounds.
    pub makespan_s: f64,
    pub merge_s: f64,
    /// The largest channel of the image, by which an exposure to the brightest pixel divides.
    pub brightest: f64,
    /// Seconds from handing over the jobs until one process has the image and `brightest`.
    pub time_to_image_s: f64,
    /// The film's checksum; none if the sampler draws other random numbers in each run.
    pub checksum: Option<String>,
    pub warnings: Vec<Warning>,
    /// The kernel's remarks on how it rendered.
    pub remarks: Vec<String>,
    /// When it started; empty if the system's clock shows no date from 1970 to 9999.
    pub started_utc: String,
    pub(super) cpu: Option<Usage>,
    pub(super) observed: Observed,
}

impl Outcome {
    pub fn provenance(&self, setup: &Setup) -> Provenance {
        let key = FilmKey { spp: self.spp, ..setup.film_key() };
        Provenance { key, checksum: self.checksum.clone() }
    }

    /// The warnings, in the format of a row.
    pub fn warned(&self) -> String {
        self.warnings.iter().map(ToString::to_string).collect::<Vec<_>>().join(";")
    }

    /// The counts of the paths that this process rendered during the makespan.
    pub fn rendered(&self) -> Counts {
        let mut rendered = Counts::default();
        self.job_counts.iter().for_each(|job| rendered.add(job));
        rendered
    }

    /// CPU seconds during the makespan, in the program and in the system.
    pub fn cpu_s(&self) -> Option<f64> {
        self.cpu.map(|usage| usage.user_s + usage.system_s)
    }
}

impl Setup {
    /// Renders, times and verifies.
    pub fn run(&self, watch: Watch<'_>) -> Result<Outcome> {
        if self.settings().adaptive {
            return self.run_adaptive(watch);
        }
        if let Some(limit) = self.settings().time_limit_s {
            return self.run_for(limit, watch);
        }
        let (spec, spp) = (&self.settings().spec, self.settings().spp);
        let mut totals = RunTotals::new();
        let films = totals.round(self, self.plan.clone(), from_ref(&(0..spp)), watch)?;
        let film = films.into_iter().next().unwrap_or_else(|| Film::new(spec.width, spec.height));
        Ok(totals.outcome(self, spp, film))
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RoundTimes {
    /// Seconds from handing over the jobs until all were done.
    pub makespan_s: f64,
    pub merge_s: f64,
    /// CPU seconds during the makespan, in the program and in the system.
    pub cpu_s: Option<f64>,
    /// Samples, over all pixels.
    pub paths: u64,
}

/// The totals of all rounds of a run so far. The strategy is made for the first round and kept.
#[derive(Default)]
pub(super) struct RunTotals {
    strategy: Option<Box<dyn Strategy>>,
    rounds: u32,
    plan: Plan,
    spans: Vec<JobSpan>,
    job_counts: Vec<Counts>,
    pub(super) history: History,
    workers_used: u32,
    /// Workers that the round with the largest shortage should have had.
    asked: usize,
    pub(super) build_s: f64,
    pilot_s: f64,
    setup_s: f64,
    pub(super) makespan_s: f64,
    pub(super) merge_s: f64,
    /// Seconds after the makespan until one process had the pieces of all.
    pub(super) gather_s: f64,
    /// `brightest`, if processes have found it together.
    pub(super) brightest: Option<f64>,
    cpu: Option<Usage>,
    observed: Observed,
    /// `None` if the settings do not ask for counters.
    counters: Option<Counters>,
    started_utc: String,
    pub(super) last: RoundTimes,
    /// Memory for the results that are made from the film after all rounds.
    reserve: Cell<Reserve>,
}

impl RunTotals {
    pub(super) fn new() -> Self {
        Self { started_utc: utc_now(), ..Self::default() }
    }

    /// Renders the plan, each of whose pieces lies in one of the sections, and returns a film for each section.
    pub(super) fn round(
        &mut self,
        setup: &Setup,
        plan: Plan,
        sections: &[Range<u32>],
        watch: Watch<'_>,
    ) -> Result<Vec<Film>> {
        let spec = &setup.settings().spec;
        let (width, height) = (spec.width, spec.height);
        // All memory known to be needed is reserved first: a refusal after hours of work would lose them.
        let films = Sections::new(width, height, sections)?;
        if self.reserve.get_mut().pixels() == 0 {
            self.reserve.set(Reserve::new(width, height)?);
        }
        let (kernel, build_s) = setup.kernel()?;
        self.build_s = build_s;
        let before_pilot = Instant::now();
        let plan = Arc::new(setup.ordered(plan, &*kernel));
        if setup.decomposition.is_by_cost() {
            self.pilot_s += before_pilot.elapsed().as_secs_f64();
        }
        let output = (setup.output.new)(Delivery {
            plan: Arc::clone(&plan),
            films,
            threads: setup.settings().threads.min(available_threads()),
        })?;
        let claims = PieceClaims::new(plan.len(), !kernel.beside().is_empty());
        let run = Arc::new(Run {
            kernel: Arc::clone(&kernel),
            claims,
            ledger: Ledger::new(plan.len(), setup.pins()),
            output,
        });
        let strategy = match &mut self.strategy {
            Some(strategy) => strategy,
            none => {
                self.counters = setup.settings().counters.then(Counters::open);
                let before_setup = Instant::now();
                let strategy = none.insert(setup.new_strategy()?);
                self.setup_s = before_setup.elapsed().as_secs_f64();
                strategy
            }
        };
        let mut timed = watched(&run, watch, || run.timed(setup, strategy.as_mut(), &plan, self.counters.as_mut()))?;
        if let Some(failure) = kernel.failure() {
            return Err(failure);
        }

        let broken = |problem: &str| {
            Error::Check(format!("strategy {} broke its contract: {problem}", setup.settings().strategy))
        };
        let Run { mut ledger, output, .. } = Arc::into_inner(run).ok_or_else(|| broken("it has kept the job"))?;
        ledger.check_pins()?;
        let entries = ledger.close().map_err(|problem| broken(&problem))?;
        timed.observed.migrations = migrations(&entries);
        let before_merge = Instant::now();
        let films = output.films();
        let merge_s = before_merge.elapsed().as_secs_f64();

        let asked = setup.strategy().workers.at_once(setup.settings().threads, plan.len());
        let (spans, counts) = entries.iter().map(|entry| (entry.span, entry.counts)).unzip();
        let workers = ledger.workers_used();
        self.enter(setup, &*kernel, Round { plan: &plan, sections, spans, counts, workers, asked, timed, merge_s });
        Ok(films)
    }

    pub(super) fn enter(&mut self, setup: &Setup, kernel: &dyn Kernel, round: Round<'_>) {
        let Round { plan, sections, spans, counts, workers, asked, timed, merge_s } = round;
        // The round with the largest shortage of workers stands for all.
        if self.plan.is_empty()
            || asked.saturating_sub(workers as usize) > self.asked.saturating_sub(self.workers_used as usize)
        {
            (self.asked, self.workers_used) = (asked, workers);
        }
        let offset_s = self.makespan_s;
        self.rounds += 1;
        self.spans.extend(spans.iter().map(|span| span.later_by(offset_s)));
        self.history.begin_round();
        for (piece, counts) in plan.pieces().iter().zip(&counts) {
            let section = sections.partition_point(|section| section.end <= piece.samples.start);
            self.history.add(&sections[section], counts);
        }
        // Only with a deterministic sampler can the invalid samples be rendered again to find them.
        if self.history.tells_few() && setup.is_deterministic() && counts.iter().any(|counts| counts.invalid > 0) {
            self.history.tell(first_invalid(kernel, plan, &counts));
        }
        self.plan.append(plan);
        self.makespan_s += timed.makespan_s;
        self.merge_s += merge_s;
        self.cpu =
            if self.rounds == 1 { timed.cpu } else { self.cpu.zip(timed.cpu).map(|(sum, more)| sum.plus(&more)) };
        self.observed = if self.rounds == 1 { timed.observed } else { self.observed.plus(&timed.observed) };
        self.last = RoundTimes {
            makespan_s: timed.makespan_s,
            merge_s,
            cpu_s: timed.cpu.map(|usage| usage.user_s + usage.system_s),
            paths: counts.iter().map(|counts| counts.paths).sum(),
        };
        self.job_counts.extend(counts);
    }

    /// The outcome of all rounds, with the film that was made of the rounds' films.
    pub(super) fn outcome(&self, setup: &Setup, spp: u32, film: Film) -> Outcome {
        self.reserve.take();
        let (counts, invalid) = (self.history.counts(), self.history.invalid.clone());
        let mut warnings = setup.warnings(&counts, spp, self.asked, self.workers_used);
        if counts.invalid > 0 {
            warnings.push(Warning::InvalidSamples { count: counts.invalid, first: invalid.clone() });
        }
        warnings.extend(self.time_warnings(setup));
        if self.started_utc.is_empty() {
            warnings.push(Warning::NoDate);
        }
        if cfg!(debug_assertions) {
            warnings.push(Warning::DebugBuild);
        }
        let kernel = setup.kernel().ok().map(|(kernel, _)| kernel);
        let before_exposure = Instant::now();
        let brightest = self.brightest.unwrap_or_else(|| film.brightest());
        let exposure_s = before_exposure.elapsed().as_secs_f64();
        Outcome {
            brightest,
            time_to_image_s: self.makespan_s + self.gather_s + self.merge_s + exposure_s,
            checksum: setup.is_deterministic().then(|| film.checksum()),
            warnings,
            remarks: kernel.as_ref().map(|kernel| kernel.remarks()).unwrap_or_default(),
            device: kernel.and_then(|kernel| kernel.costs()),
            film,
            spp,
            rounds: self.rounds,
            plan: Arc::new(self.plan.clone()),
            trace: Trace { jobs: self.spans.clone() },
            job_counts: self.job_counts.clone(),
            counts,
            invalid,
            workers_used: self.workers_used,
            build_s: self.build_s,
            pilot_s: self.pilot_s,
            setup_s: self.setup_s,
            makespan_s: self.makespan_s,
            merge_s: self.merge_s,
            started_utc: self.started_utc.clone(),
            cpu: self.cpu,
            observed: self.observed,
        }
    }

    fn time_warnings(&self, setup: &Setup) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.makespan_s < shortest_s(setup.settings().is_serial()) {
            warnings.push(Warning::TooShort);
        }
        let mut unmeasured = if self.rounds == 0 { Vec::new() } else { Usage::missing(self.cpu.as_ref()) };
        if self.rounds > 0 && setup.settings().counters {
            unmeasured.extend(self.observed.missing_counters());
        }
        if !unmeasured.is_empty() {
            warnings.push(Warning::Unmeasured(unmeasured));
        }
        let capacity_s = self.makespan_s * available_threads() as f64;
        let percent = |seconds: Option<f64>| {
            let disturbs = |seconds: &f64| *seconds > FOREIGN_SHARE * capacity_s && *seconds > FOREIGN_LEAST_S;
            seconds.filter(disturbs).map(|seconds| (100.0 * seconds / capacity_s).round() as u32)
        };
        if let Some(percent) = percent(self.cpu.and_then(|usage| usage.foreign_s)) {
            warnings.push(Warning::ForeignLoad { percent });
        }
        if let Some(percent) = percent(self.cpu.and_then(|usage| usage.steal_s)) {
            warnings.push(Warning::Steal { percent });
        }
        warnings
    }
}

/// Runs `work` while another thread reports progress. If the system refuses that thread, the work is not begun: it
/// would most likely get no workers either.
fn watched<T>(run: &Run, watch: Watch<'_>, work: impl FnOnce() -> Result<T>) -> Result<T> {
    let Some(watch) = watch else { return work() };
    thread::scope(|scope| {
        let (stop, stopped) = channel::<()>();
        let tell = move || {
            while stopped.recv_timeout(Duration::from_millis(100)) == Err(RecvTimeoutError::Timeout) {
                watch(run.ledger.done());
            }
        };
        let started = thread::Builder::new().spawn_scoped(scope, tell);
        let done =
            started.map_err(|e| Error::system("starting", "the thread that shows progress", e)).and_then(|_| work());
        drop(stop);
        done
    })
}

struct Run {
    kernel: Arc<dyn Kernel>,
    claims: PieceClaims,
    ledger: Ledger,
    output: Box<dyn Output>,
}

pub(super) struct Timed {
    pub(super) makespan_s: f64,
    pub(super) cpu: Option<Usage>,
    pub(super) observed: Observed,
}

pub(super) struct Round<'a> {
    pub(super) plan: &'a Plan,
    pub(super) sections: &'a [Range<u32>],
    pub(super) spans: Vec<JobSpan>,
    pub(super) counts: Vec<Counts>,
    /// Workers that had jobs, and those that should have had some.
    pub(super) workers: u32,
    pub(super) asked: usize,
    pub(super) timed: Timed,
    pub(super) merge_s: f64,
}

impl Run {
    fn timed(
        self: &Arc<Self>,
        setup: &Setup,
        strategy: &mut dyn Strategy,
        plan: &Plan,
        mut counters: Option<&mut Counters>,
    ) -> Result<Timed> {
        let shared = Arc::clone(self);
        let before = Before::now(counters.as_deref_mut());
        let usage = Usage::now();
        let start = Instant::now();
        let job = Arc::new(move |index: usize| {
            let Self { kernel, claims, ledger, output } = &*shared;
            if claims.take(index) {
                ledger.record(index, start, || output.render(index, &**kernel));
            }
        });
        let work = || setup.keeping_affinity(|| strategy.run(plan.len(), job));
        let shared = Shared { plan, claims: &self.claims, ledger: &self.ledger, output: &*self.output };
        shared.beside(self.kernel.beside(), start, work)?;
        let makespan_s = start.elapsed().as_secs_f64();
        let cpu = usage.zip(Usage::now()).map(|(before, after)| after.since(&before));
        Ok(Timed { makespan_s, cpu, observed: before.observed(counters) })
    }
}
