//! Settings that have been checked, and the run itself.

use super::cut::{costs, cut};
use super::output::{self, OUTPUTS};
use super::{Settings, Warning, available_threads};
use crate::digest;
use crate::error::{Error, InputError, Result};
use crate::estimator::Estimator;
use crate::film::{Decomposition, Plan};
use crate::kernel::workload::Entry as Workload;
use crate::kernel::{self, Clamped, Counts, CustomEstimator, Kernel, RenderOptions, Spec, Tables};
use crate::lab::{Lab, RankRule, THREAD_PER_ROW};
use crate::machine::KeptAffinity;
use crate::scene::{SUBPIXELS, Scene};
use crate::settings::check_spp;
use crate::strategy::{self, Config, Strategy, StrategyError, Workers};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::slice::from_ref;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// A run that can start: all user input has been checked, and all names have been looked up.
#[derive(Clone)]
pub struct Setup {
    settings: Settings,
    subject: Subject,
    /// Made by the first run: a large scene's acceleration structure takes seconds to build, and a check of settings
    /// needs no kernel.
    built: OnceLock<Built>,
    pub(super) decomposition: Decomposition,
    /// The pieces of all requested samples.
    pub(super) plan: Plan,
    pub(super) output: &'static output::Entry,
    strategy: strategy::Entry,
    parameter: Option<String>,
    rank_rule: Option<RankRule>,
    /// The processor of each worker; empty if workers are not pinned.
    pins: Vec<usize>,
}

#[derive(Clone)]
enum Subject {
    Scene {
        scene: Arc<Scene>,
        choice: Box<RenderOptions>,
    },
    /// Work that is unrelated to light.
    Workload(Workload),
}

#[derive(Clone)]
struct Built {
    kernel: Arc<dyn Kernel>,
    build_s: f64,
}

impl Subject {
    fn choice(&self) -> Option<&RenderOptions> {
        match self {
            Self::Scene { choice, .. } => Some(choice),
            Self::Workload(_) => None,
        }
    }

    fn spp_multiple(&self) -> u32 {
        self.choice().map_or(1, |choice| choice.estimator.spp_multiple)
    }

    fn kernel(&self, spec: &Spec) -> Result<Box<dyn Kernel>> {
        match self {
            Self::Scene { scene, choice } => choice.build(scene),
            Self::Workload(workload) => Ok(workload.kernel(spec.width, spec.height, spec.seed)),
        }
    }
}

impl Lab {
    /// Checks the settings, loads the scene and cuts the film into pieces.
    pub fn prepare(&self, settings: Settings) -> Result<Setup> {
        if let Some(workload) = self.workload_named(&settings.scene) {
            let Spec { width, height, seed, .. } = settings.spec;
            let nothing = Spec { estimator: String::new(), sampler: String::new(), ..Spec::default() };
            let spec = Spec { width, height, seed, ..nothing };
            return Setup::new(self, Subject::Workload(workload.clone()), Settings { spec, ..settings });
        }
        let scene = Arc::new(self.load_scene(&settings.scene)?);
        self.prepare_scene(scene, settings)
    }

    /// The same for a loaded scene; `settings.scene` is not read.
    pub fn prepare_scene(&self, scene: Arc<Scene>, settings: Settings) -> Result<Setup> {
        let choice = Box::new(kernel::choose_among(&scene, &settings.spec, self.kernel_tables())?);
        Setup::new(self, Subject::Scene { scene, choice }, settings)
    }
}

impl Setup {
    /// [`Lab::prepare`] with the built-in parts.
    pub fn prepare(settings: Settings) -> Result<Self> {
        Lab::built_in().prepare(settings)
    }

    /// [`Lab::prepare_scene`] with the built-in parts.
    pub fn for_scene(scene: Arc<Scene>, settings: Settings) -> Result<Self> {
        Lab::built_in().prepare_scene(scene, settings)
    }

    fn new(lab: &Lab, subject: Subject, settings: Settings) -> Result<Self> {
        let settings = settings.resolved();
        settings.check()?;
        check_spp(settings.spp, &settings.spec.estimator, subject.spp_multiple())?;
        let rank_rule = settings.rank_rule.as_deref().map(|rule| lab.rank_rule("rank-rule", rule)).transpose()?;
        let decomposition = Decomposition::parse(&settings.decomposition)?;
        let (strategy, parameter) = lab.strategy_named(&settings.strategy).map_err(|error| match error {
            // Report A's name for a strategy together with its pieces is allowed too.
            Error::Input(input)
                if !lab.strategies().iter().any(|entry| input.value.split(':').next() == Some(entry.name)) =>
            {
                let allowed = format!("{}, {THREAD_PER_ROW}", input.allowed);
                input.allowed(allowed).into()
            }
            other => other,
        })?;
        let Some(output) = OUTPUTS.iter().find(|entry| entry.name == settings.output) else {
            let names: Vec<&str> = OUTPUTS.iter().map(|entry| entry.name).collect();
            return Err(InputError::new("output", &settings.output, "there is none of that name")
                .allowed(names.join(", "))
                .into());
        };
        let clamp = subject.choice().and_then(|choice| choice.clamp);
        if clamp.is_some_and(|clamp| clamp.what == Clamped::Subpixel) && decomposition.splits_samples() {
            let problem = "cannot be combined with the subpixel clamp, which needs all samples of a pixel at once";
            return Err(InputError::new("decomposition", &settings.decomposition, problem).into());
        }
        let size = [settings.spec.width, settings.spec.height];
        let plan = cut(&decomposition, &strategy, size, from_ref(&(0..settings.spp)))?;
        let mut setup = Self {
            subject,
            built: OnceLock::new(),
            decomposition,
            plan,
            output,
            strategy,
            parameter,
            rank_rule,
            pins: Vec::new(),
            settings,
        };
        setup.check_adaptive()?;
        setup.pins = setup.settings.pin.cpus(setup.threads())?;
        Ok(setup)
    }

    /// The same run with other samples of the same radiance, without clamping.
    pub(super) fn pilot(&self, spp: u32, seed: u64) -> Result<Self> {
        check_spp(spp, &self.settings.spec.estimator, self.spp_multiple())?;
        let plan = self.plan_of(from_ref(&(0..spp)))?;
        let mut pilot = Self { plan, built: OnceLock::new(), ..self.clone() };
        let Settings { spp: own, spec, adaptive, .. } = &mut pilot.settings;
        (*own, spec.seed, spec.clamp, *adaptive) = (spp, seed, None, false);
        if let Subject::Scene { choice, .. } = &mut pilot.subject {
            **choice = choice.as_ref().clone().pilot(seed);
        }
        Ok(pilot)
    }

    /// The same run with `estimator` in place of the one that the settings name. Records say `name`.
    ///
    /// ```
    /// use pathmark_harness::effect::EffectSet;
    /// use pathmark_harness::estimator::{Estimator, Probe};
    /// use pathmark_harness::math::{Ray, Rgb};
    /// use pathmark_harness::measure::{Settings, Setup};
    /// use pathmark_harness::sampling::{SampleKey, Sampler};
    /// use pathmark_harness::scene::Scene;
    ///
    /// /// Sees white wherever it looks.
    /// struct White;
    ///
    /// impl Estimator for White {
    ///     const SPP_MULTIPLE: u32 = 1;
    ///     fn sample<S: Sampler, X: EffectSet, P: Probe>(&self, _: &Scene, _: Ray, _: SampleKey, _: &S, _: &mut P) -> Rgb {
    ///         Rgb::WHITE
    ///     }
    /// }
    ///
    /// let setup = Setup::prepare(Settings { scene: "cornell".into(), spp: 4, ..Settings::default() })?;
    /// let outcome = setup.with("white", White)?.run(None)?;
    /// assert_eq!(outcome.film.pixels()[0].mean(), [1.0; 3]);
    /// # Ok::<(), pathmark_harness::error::Error>(())
    /// ```
    pub fn with<E: Estimator + 'static>(mut self, name: &'static str, estimator: E) -> Result<Self> {
        self.settings.spec.estimator = name.to_string();
        if let Subject::Scene { scene, choice } = &mut self.subject {
            let estimators = &[CustomEstimator::new(name, estimator)];
            let tables = Tables { estimators, ..kernel::TABLES };
            **choice = kernel::choose_among(scene, &self.settings.spec, tables)?;
        }
        check_spp(self.settings.spp, name, self.spp_multiple())?;
        self.built = OnceLock::new();
        Ok(self)
    }

    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    pub fn name(&self) -> &str {
        match &self.subject {
            Subject::Scene { scene, .. } => &scene.name,
            Subject::Workload(workload) => workload.name,
        }
    }

    /// The scene's hash, or for a workload a hash of its name.
    pub fn hash(&self) -> String {
        match &self.subject {
            Subject::Scene { scene, .. } => scene.hash.clone(),
            Subject::Workload(workload) => digest::of_text(&format!("workload {}", workload.name)),
        }
    }

    pub fn files(&self) -> &[PathBuf] {
        self.scene().map_or(&[], |(scene, _)| &scene.files)
    }

    /// Remarks for the scene's author: on its files, its light, and meshes that the camera does not see.
    pub fn remarks(&self) -> Vec<String> {
        self.scene().map_or_else(Vec::new, |(scene, choice)| scene.remarks_in(&choice.view(scene)))
    }

    /// The scene, and the choices that the settings make for it; `None` for a workload.
    pub fn scene(&self) -> Option<(&Arc<Scene>, &RenderOptions)> {
        match &self.subject {
            Subject::Scene { scene, choice } => Some((scene, choice)),
            Subject::Workload(_) => None,
        }
    }

    /// The number of samples per pixel must be a multiple of this.
    pub fn spp_multiple(&self) -> u32 {
        self.subject.spp_multiple()
    }

    /// Builds the kernel now instead of in the first run.
    pub fn build(&self) -> Result<()> {
        self.kernel().map(drop)
    }

    /// The kernel, for which the first caller waits, and the seconds of its construction.
    pub(super) fn kernel(&self) -> Result<(Arc<dyn Kernel>, f64)> {
        let built = if let Some(built) = self.built.get() {
            built
        } else {
            let before = Instant::now();
            let kernel = Arc::from(self.subject.kernel(&self.settings.spec)?);
            self.built.get_or_init(|| Built { kernel, build_s: before.elapsed().as_secs_f64() })
        };
        Ok((Arc::clone(&built.kernel), built.build_s))
    }

    pub fn jobs(&self) -> usize {
        self.plan.len()
    }

    /// Number of workers: the requested one, unless the strategy has its own rule.
    pub fn threads(&self) -> usize {
        match self.strategy.workers {
            Workers::Caller => 1,
            Workers::PerJob => self.jobs(),
            Workers::Threads => self.settings.threads,
        }
    }

    /// Fewest samples per pixel of a whole image: enough for the estimator, and one for each subpixel if the camera has
    /// them.
    pub fn fewest_spp(&self) -> u32 {
        let multiple = self.spp_multiple();
        let subpixels = if self.has_subpixels() { SUBPIXELS } else { 1 };
        if multiple.is_multiple_of(subpixels) { multiple } else { multiple * subpixels }
    }

    fn has_subpixels(&self) -> bool {
        self.scene().is_some_and(|(scene, choice)| choice.subpixels(scene) > 1)
    }

    /// Whether the film's checksum is meaningful: the sampler draws the same random numbers each time.
    pub fn is_deterministic(&self) -> bool {
        self.scene().is_none_or(|(_, choice)| choice.sampler.deterministic)
    }

    pub fn strategy(&self) -> &strategy::Entry {
        &self.strategy
    }

    pub fn rank_rule(&self) -> Option<&RankRule> {
        self.rank_rule.as_ref()
    }

    pub(super) fn ordered(&self, plan: Plan, kernel: &dyn Kernel) -> Plan {
        if self.decomposition.is_by_cost() { plan.clone().longest_first(&costs(&plan, kernel)) } else { plan }
    }

    pub(super) fn new_strategy(&self) -> Result<Box<dyn Strategy>> {
        if let Some(rule) = &self.rank_rule {
            let problem = "shares jobs among processes, but there is only one";
            return Err(InputError::new("rank-rule", rule.to_string(), problem)
                .allowed("an experiment, or render --ranks")
                .into());
        }
        let threads = NonZeroUsize::new(self.settings.threads).unwrap_or(NonZeroUsize::MIN);
        let config = Config { parameter: self.parameter.clone(), ..Config::new(threads) };
        self.strategy.build(config).map_err(|error| self.strategy_error(error))
    }

    /// The processor of each worker, in the order of their first jobs; empty if workers are not pinned.
    pub fn pins(&self) -> &[usize] {
        &self.pins
    }

    /// Lets a strategy run jobs, and then gives this thread its affinity back: the strategy `serial` runs jobs on it. Other
    /// threads that were pinned belong to the strategy. They end with it, or are pinned again in its next round.
    pub(super) fn keeping_affinity(&self, run: impl FnOnce() -> std::result::Result<(), StrategyError>) -> Result<()> {
        let kept = (!self.pins.is_empty()).then(KeptAffinity::of_thread);
        let ran = run();
        drop(kept);
        ran.map_err(|error| self.strategy_error(error))
    }

    fn strategy_error(&self, error: StrategyError) -> Error {
        Error::system("running strategy", self.strategy.name, std::io::Error::other(error))
    }

    /// Doubts about a run of `spp` samples in which `workers_used` of `asked` workers had jobs.
    pub(super) fn warnings(&self, counts: &Counts, spp: u32, asked: usize, workers_used: u32) -> Vec<Warning> {
        let mut warnings = Vec::new();
        if (workers_used as usize) < asked {
            warnings.push(Warning::WorkersUnused { asked, used: workers_used });
        }
        let processors = available_threads();
        // Workers that serve devices wait for them.
        let waiting = self.subject.choice().map_or(0, |choice| choice.plan.devices_beside());
        if workers_used as usize > processors + waiting {
            warnings.push(Warning::Oversubscribed { workers: workers_used, processors });
        }
        if self.has_subpixels() && !spp.is_multiple_of(SUBPIXELS) {
            warnings.push(Warning::PartialSubpixels);
        }
        let Some((scene, choice)) = self.scene() else { return warnings };
        let left_out = scene.primitives.degenerate;
        if left_out > 0 {
            warnings.push(Warning::LeftOut(left_out));
        }
        if choice.is_biased() {
            warnings.push(Warning::Biased);
        }
        // A background opens the scene on purpose, and a depth limit cuts paths on purpose.
        let leaks = if scene.background.is_none() { counts.escaped } else { 0 };
        let cuts = if choice.depth().is_none() { counts.truncated } else { 0 };
        let counted = [(leaks, Warning::Escaped(leaks)), (cuts, Warning::Truncated(cuts))];
        warnings.extend(counted.into_iter().filter(|(count, _)| *count > 0).map(|(_, warning)| warning));
        warnings
    }
}
