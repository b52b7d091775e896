//! Settings that have been checked, and the run itself.

use super::ledger::Ledger;
use super::output::{self, Delivery, OUTPUTS, Output};
use super::settings::{LARGEST_THREADS, strategy_named};
use super::usage::Usage;
use super::{Settings, THREAD_PER_ROW, Trace, Warning, available_threads, pilot};
use crate::error::{Error, InputError, Result};
use crate::film::{Decomposition, Film, FilmKey, Plan};
use crate::kernel::{self, Choice, Counts, Kernel};
use crate::sampling::is_deterministic;
use crate::scene::{Filter, SUBPIXELS, Scene};
use crate::strategy::{self, Config, Strategy, StrategyError, Workers};
use std::num::NonZeroUsize;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant, SystemTime};

/// A run that can start: everything that the user could have got wrong has been checked.
pub struct Setup {
    settings: Settings,
    scene: Arc<Scene>,
    choice: Choice,
    /// Made by the first run: what accelerates a large scene takes seconds to build, and whoever only checks settings needs no kernel.
    built: OnceLock<Built>,
    plan: Plan,
    by_cost: bool,
    output: &'static output::Entry,
    strategy: &'static strategy::Entry,
    parameter: Option<String>,
}

/// A kernel, and how long it took to build.
struct Built {
    kernel: Arc<dyn Kernel>,
    build_s: f64,
}

/// What a run gave.
pub struct Outcome {
    /// The image's sums.
    pub film: Film,
    /// The pieces, in the order in which they were handed out.
    pub plan: Arc<Plan>,
    /// Who did what when.
    pub trace: Trace,
    /// What happened on the paths, job by job.
    pub job_counts: Vec<Counts>,
    /// What happened on the paths.
    pub counts: Counts,
    /// Threads that ran at least one job.
    pub workers_used: u32,
    /// Seconds to build the kernel and what accelerates the scene; once for all runs of a setup.
    pub build_s: f64,
    /// Seconds to find out what the pieces will cost, where their order depends on it.
    pub pilot_s: f64,
    /// Seconds to make the strategy.
    pub setup_s: f64,
    /// Seconds from handing over the jobs until all were done.
    pub makespan_s: f64,
    /// Seconds to put the pieces together.
    pub merge_s: f64,
    /// The film's checksum; none if the sampler gives other numbers in each run.
    pub checksum: Option<String>,
    /// What a reader should know.
    pub warnings: Vec<Warning>,
    /// When it started.
    pub started_utc: String,
    /// What the system counted during the makespan.
    pub(super) cpu: Option<Usage>,
}

impl Outcome {
    /// CPU seconds during the makespan, in the program and in the system.
    pub fn cpu_s(&self) -> Option<f64> {
        self.cpu.map(|usage| usage.user_s + usage.system_s)
    }
}

impl Setup {
    /// Checks the settings, loads the scene and cuts the film.
    pub fn prepare(settings: Settings) -> Result<Self> {
        let scene = Arc::new(crate::scene::load(&settings.scene)?);
        Self::for_scene(scene, settings)
    }

    /// Likewise, for a scene that is already there; `settings.scene` is not looked at.
    pub fn for_scene(scene: Arc<Scene>, settings: Settings) -> Result<Self> {
        let settings = settings.resolved();
        settings.check()?;
        let decomposition = Decomposition::parse(&settings.decomposition)?;
        let (strategy, parameter) = strategy_named(&settings.strategy).map_err(|error| match error {
            Error::Input(input) if strategy::find(&input.value).is_none() => also_per_row(*input),
            other => other,
        })?;
        let Some(output) = output::find(&settings.output) else {
            let names: Vec<&str> = OUTPUTS.iter().map(|entry| entry.name).collect();
            return Err(InputError::new("output", &settings.output, "there is none of that name")
                .allowed(names.join(", "))
                .into());
        };
        if settings.spec.subpixel_clamp && decomposition.splits_samples() {
            let problem = "cannot be combined with the subpixel clamp, which needs all samples of a pixel at once";
            return Err(InputError::new("decomposition", &settings.decomposition, problem).into());
        }
        let plan = decomposition.plan(settings.spec.width, settings.spec.height, &(0..settings.spp));
        if strategy.workers == Workers::PerJob && plan.len() > LARGEST_THREADS {
            let problem = format!("cuts {} jobs, and {} starts a thread for each", plan.len(), strategy.name);
            return Err(InputError::new("decomposition", &settings.decomposition, problem)
                .allowed(format!("at most {LARGEST_THREADS} jobs"))
                .into());
        }
        let choice = kernel::choose(&scene, &settings.spec)?;
        Ok(Self {
            scene,
            choice,
            built: OnceLock::new(),
            plan,
            by_cost: decomposition.is_by_cost(),
            output,
            strategy,
            parameter,
            settings,
        })
    }

    /// What was asked for.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Name of the effect profile.
    pub fn effects(&self) -> &'static str {
        self.choice.effects()
    }

    /// Name of the accelerator.
    pub fn accelerator(&self) -> &'static str {
        self.choice.accelerator()
    }

    /// Whether rays are tested against boxes before primitives.
    pub fn is_hierarchical(&self) -> bool {
        self.choice.is_hierarchical()
    }

    /// The kernel, which the first to ask has to wait for.
    fn built(&self) -> Result<&Built> {
        if let Some(built) = self.built.get() {
            return Ok(built);
        }
        let before = Instant::now();
        let kernel = Arc::from(kernel::build(&self.scene, &self.settings.spec)?);
        Ok(self.built.get_or_init(|| Built { kernel, build_s: before.elapsed().as_secs_f64() }))
    }

    /// How many jobs there are.
    pub fn jobs(&self) -> usize {
        self.plan.len()
    }

    /// How many workers there will be: what was asked for, unless the strategy has its own rule.
    pub fn threads(&self) -> usize {
        match self.strategy.workers {
            Workers::Caller => 1,
            Workers::PerJob => self.jobs(),
            Workers::Threads => self.settings.threads,
        }
    }

    /// What the film will be of.
    pub fn film_key(&self) -> FilmKey {
        let spec = &self.settings.spec;
        FilmKey {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            estimator: spec.estimator.clone(),
            sampler: spec.sampler.clone(),
            seed: spec.seed,
            spp: self.settings.spp,
            width: spec.width,
            height: spec.height,
            max_depth: spec.max_depth,
            roulette: spec.roulette.clone(),
            revision: kernel::REVISION,
        }
    }

    /// Whether the film's checksum says anything: whether the sampler gives the same numbers each time.
    pub fn is_deterministic(&self) -> bool {
        is_deterministic(&self.settings.spec.sampler)
    }

    /// What the strategy does with its jobs.
    pub fn strategy(&self) -> &'static strategy::Entry {
        self.strategy
    }

    /// Renders, times and verifies. `watch` is told the number of jobs done now and then, from another thread.
    pub fn run(&self, watch: Option<&(dyn Fn(u64) + Sync)>) -> Result<Outcome> {
        let started_utc = humantime::format_rfc3339_seconds(SystemTime::now()).to_string();
        let Built { kernel, build_s } = self.built()?;
        let before_pilot = Instant::now();
        let plan = Arc::new(self.ordered_plan(&**kernel));
        let pilot_s = if self.by_cost { before_pilot.elapsed().as_secs_f64() } else { 0.0 };
        let run = Arc::new(Run {
            kernel: Arc::clone(kernel),
            ledger: Ledger::new(plan.len()),
            output: (self.output.new)(self.delivery(&plan)),
        });
        let before_setup = Instant::now();
        let mut strategy = self.new_strategy()?;
        let setup_s = before_setup.elapsed().as_secs_f64();

        let timed = match watch {
            None => self.timed_run(strategy.as_mut(), &run)?,
            Some(watch) => std::thread::scope(|scope| {
                let (stop, stopped) = std::sync::mpsc::channel::<()>();
                let watched = Arc::clone(&run);
                scope.spawn(move || {
                    while stopped.recv_timeout(Duration::from_millis(100))
                        == Err(std::sync::mpsc::RecvTimeoutError::Timeout)
                    {
                        watch(watched.ledger.done());
                    }
                });
                let timed = self.timed_run(strategy.as_mut(), &run);
                drop(stop);
                timed
            })?,
        };
        drop(strategy);

        let entries = run.ledger.close().map_err(|problem| {
            Error::Check(format!("strategy {} broke its contract: {problem}", self.settings.strategy))
        })?;
        let before_merge = Instant::now();
        let film = run.output.film();
        let merge_s = before_merge.elapsed().as_secs_f64();

        let job_counts: Vec<Counts> = entries.iter().map(|entry| entry.counts).collect();
        let mut counts = Counts::default();
        for job in &job_counts {
            counts.add(job);
        }
        let workers_used = run.ledger.workers_used();
        let mut warnings = self.warnings(&counts, workers_used);
        warnings.extend(timed.warnings());
        Ok(Outcome {
            checksum: self.is_deterministic().then(|| film.checksum()),
            warnings,
            plan,
            trace: Trace { jobs: entries.iter().map(|entry| entry.span).collect() },
            job_counts,
            film,
            counts,
            workers_used,
            build_s: *build_s,
            pilot_s,
            setup_s,
            makespan_s: timed.makespan_s,
            merge_s,
            started_utc,
            cpu: timed.cpu,
        })
    }

    fn ordered_plan(&self, kernel: &dyn Kernel) -> Plan {
        let plan = self.plan.clone();
        if self.by_cost { plan.clone().longest_first(&pilot::costs(&plan, kernel)) } else { plan }
    }

    fn delivery(&self, plan: &Arc<Plan>) -> Delivery {
        let spec = &self.settings.spec;
        Delivery { plan: Arc::clone(plan), width: spec.width, height: spec.height, spp: self.settings.spp }
    }

    fn new_strategy(&self) -> Result<Box<dyn Strategy>> {
        let threads = NonZeroUsize::new(self.settings.threads).unwrap_or(NonZeroUsize::MIN);
        let config = Config { parameter: self.parameter.clone(), ..Config::new(threads) };
        (self.strategy.new)(config).map_err(|error| self.strategy_error(error))
    }

    fn timed_run(&self, strategy: &mut dyn Strategy, run: &Arc<Run>) -> Result<Timed> {
        let jobs = self.plan.len();
        let shared = Arc::clone(run);
        let usage = Usage::now();
        let start = Instant::now();
        let job = Arc::new(move |index: usize| {
            let Run { kernel, ledger, output } = &*shared;
            ledger.record(index, start, || output.render(index, &**kernel));
        });
        strategy.run(jobs, job).map_err(|error| self.strategy_error(error))?;
        let makespan_s = start.elapsed().as_secs_f64();
        Ok(Timed { makespan_s, cpu: usage.zip(Usage::now()).map(|(before, after)| after.since(&before)) })
    }

    fn strategy_error(&self, error: StrategyError) -> Error {
        Error::system("running strategy", self.strategy.name, std::io::Error::other(error))
    }

    fn warnings(&self, counts: &Counts, workers_used: u32) -> Vec<Warning> {
        let mut warnings = Vec::new();
        let asked = self.strategy.workers.at_once(self.settings.threads, self.plan.len());
        if (workers_used as usize) < asked {
            warnings.push(Warning::WorkersUnused { asked, used: workers_used });
        }
        let processors = available_threads();
        if workers_used as usize > processors {
            warnings.push(Warning::Oversubscribed { workers: workers_used, processors });
        }
        if self.scene.camera.filter == Filter::Subpixels && !self.settings.spp.is_multiple_of(SUBPIXELS) {
            warnings.push(Warning::PartialSubpixels);
        }
        let left_out = self.scene.primitives.degenerate;
        if left_out > 0 {
            warnings.push(Warning::LeftOut(left_out));
        }
        if self.settings.spec.is_biased() {
            warnings.push(Warning::Biased);
        }
        // Where a background says that the scene is open, or a depth that paths are to be cut, that is what was asked for.
        let leaks = if self.scene.background.is_none() { counts.escaped } else { 0 };
        let cuts = if self.settings.spec.depth().is_none() { counts.truncated } else { 0 };
        let counted = [
            (leaks, Warning::Escaped(leaks)),
            (cuts, Warning::Truncated(cuts)),
            (counts.invalid, Warning::InvalidSamples(counts.invalid)),
        ];
        warnings.extend(counted.into_iter().filter(|(count, _)| *count > 0).map(|(_, warning)| warning));
        if cfg!(debug_assertions) {
            warnings.push(Warning::DebugBuild);
        }
        warnings
    }
}

/// Where a strategy is named together with its pieces, report A's name for both is allowed too.
fn also_per_row(error: InputError) -> Error {
    let allowed = format!("{}, {THREAD_PER_ROW}", error.allowed);
    error.allowed(allowed).into()
}

/// What all jobs of a run share.
struct Run {
    kernel: Arc<dyn Kernel>,
    ledger: Ledger,
    output: Box<dyn Output>,
}

struct Timed {
    makespan_s: f64,
    cpu: Option<Usage>,
}

impl Timed {
    fn warnings(&self) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if self.makespan_s < SHORTEST_S {
            warnings.push(Warning::TooShort);
        }
        let capacity_s = self.makespan_s * available_threads() as f64;
        if let Some(foreign_s) = self.cpu.and_then(|usage| usage.foreign_s)
            && foreign_s > FOREIGN_SHARE * capacity_s
            && foreign_s > FOREIGN_LEAST_S
        {
            warnings.push(Warning::ForeignLoad { percent: (100.0 * foreign_s / capacity_s).round() as u32 });
        }
        warnings
    }
}

/// In shorter runs the start of threads and a single interruption weigh more than the schedule.
const SHORTEST_S: f64 = 5e-3;
/// Other programs' share of the processors from which they are mentioned.
const FOREIGN_SHARE: f64 = 0.05;
/// The system counts in hundredths of a second, once for each processor: less than this may be rounding.
const FOREIGN_LEAST_S: f64 = 0.03;
