//! The lab: tables of everything that a user can choose by name, built in or added by a program.
//!
//! Cells of experiments run in processes of the same program, so they have the same tables.

mod rank_rule;

use crate::error::{InputError, Result};
use crate::estimator::{ESTIMATORS, Entry as EstimatorEntry, Estimator};
use crate::kernel::workload::{self, WORKLOADS, Workload};
use crate::kernel::{CustomEstimator, KernelEntry, TABLES, Tables};
use crate::scene::{CustomScene, Library, Scene};
use crate::shell;
use crate::strategy::{Entry as Strategy, LEFT_OUT, STRATEGIES, StrategyError};
pub use rank_rule::{Distribution, LOOK, Master, RankRule, is_small};
use std::fmt;
use std::panic::Location;
use std::sync::{Arc, LazyLock};

/// Report A's name for the strategy `thread-per-job` on the decomposition `rows`.
pub const THREAD_PER_ROW: &str = "thread-per-row";

/// The strategy that speedups are compared with.
pub const SERIAL: &str = "serial";

pub struct Lab {
    name: Option<&'static str>,
    version: Option<&'static str>,
    strategies: Vec<Strategy>,
    kernels: Vec<KernelEntry>,
    estimators: Vec<CustomEstimator>,
    workloads: Vec<workload::Entry>,
    scenes: Library,
    experiments: Vec<(String, String)>,
    claims: Vec<(String, String)>,
    /// Names that a program added: kind, name and source location.
    added: Vec<(&'static str, String, &'static Location<'static>)>,
    /// The error for the first name that was already taken.
    problem: Option<InputError>,
}

static BUILT_IN: LazyLock<Arc<Lab>> = LazyLock::new(|| Arc::new(Lab::new()));

impl fmt::Debug for Lab {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Lab").field("added", &self.added).finish_non_exhaustive()
    }
}

impl Default for Lab {
    fn default() -> Self {
        Self::new()
    }
}

impl Lab {
    pub fn new() -> Self {
        Self {
            name: None,
            version: None,
            strategies: STRATEGIES.to_vec(),
            kernels: TABLES.kernels.to_vec(),
            estimators: Vec::new(),
            workloads: WORKLOADS.to_vec(),
            scenes: Library::default(),
            experiments: Vec::new(),
            claims: Vec::new(),
            added: Vec::new(),
            problem: None,
        }
    }

    /// Returns the built-in tables, shared, for programs that add nothing.
    pub fn built_in() -> Arc<Self> {
        Arc::clone(&BUILT_IN)
    }

    /// Names the program, for `machine.toml`, the page and `--version`. Without a name it is that of the executable.
    #[must_use]
    pub fn name(self, name: &'static str) -> Self {
        Self { name: Some(name), ..self }
    }

    /// Sets the program's version, usually `env!("CARGO_PKG_VERSION")`.
    #[must_use]
    pub fn version(self, version: &'static str) -> Self {
        Self { version: Some(version), ..self }
    }

    /// Returns name and version of the program, and Pathmark's version if the program is another one.
    pub fn program(&self) -> [String; 2] {
        let name = self.name.map_or_else(shell::executable_name, str::to_string);
        let version = match self.version {
            None if name == "pathmark" => env!("CARGO_PKG_VERSION").to_string(),
            None => concat!("(Pathmark ", env!("CARGO_PKG_VERSION"), ")").to_string(),
            Some(own) => format!("{own} (Pathmark {})", env!("CARGO_PKG_VERSION")),
        };
        [name, version]
    }

    /// Whether the program adds nothing to Pathmark, not even a name: whoever installs Pathmark has it.
    pub fn is_pathmark(&self) -> bool {
        self.name.is_none() && self.version.is_none() && self.added.is_empty()
    }

    #[must_use]
    #[track_caller]
    pub fn strategy(mut self, entry: Strategy) -> Self {
        let taken = entry.name == THREAD_PER_ROW || self.strategies.iter().any(|known| known.name == entry.name);
        self.note("strategy", entry.name, taken, Location::caller());
        self.strategies.push(entry);
        self
    }

    /// Adds a kernel, whose plan says for each scene whether it can render it.
    #[must_use]
    #[track_caller]
    pub fn kernel(mut self, entry: KernelEntry) -> Self {
        let taken = self.kernels.iter().any(|known| known.is_meant_by(entry.name) || entry.is_meant_by(known.name));
        self.note("kernel", entry.name, taken, Location::caller());
        self.kernels.push(entry);
        self
    }

    #[must_use]
    #[track_caller]
    pub fn estimator<E: Estimator + 'static>(mut self, name: &'static str, estimator: E) -> Self {
        let taken = self.estimators().any(|known| known.name == name);
        self.note("estimator", name, taken, Location::caller());
        self.estimators.push(CustomEstimator::new(name, estimator));
        self
    }

    /// Adds a workload. Workloads and scenes share one set of names, because a workload can take the place of a scene.
    #[must_use]
    #[track_caller]
    pub fn workload(mut self, name: &'static str, workload: impl Workload) -> Self {
        let taken = self.is_subject(name);
        self.note("workload", name, taken, Location::caller());
        self.workloads.push(workload::Entry::custom(name, workload));
        self
    }

    /// Adds a scene in TOML, which is read only when the scene is used.
    #[must_use]
    #[track_caller]
    pub fn scene(mut self, name: &str, text: &str) -> Self {
        let taken = self.is_subject(name);
        self.note("scene", name, taken, Location::caller());
        self.scenes.add(CustomScene { name: name.to_string(), text: text.to_string() });
        self
    }

    /// Adds an experiment in TOML, which `reproduce` runs with the others.
    #[must_use]
    #[track_caller]
    pub fn experiment(mut self, name: &str, text: &str) -> Self {
        let taken = self.experiments.iter().any(|(known, _)| known == name);
        self.note("experiment", name, taken, Location::caller());
        self.experiments.push((name.to_string(), text.to_string()));
        self
    }

    /// Adds a ledger in TOML: `claims` judges the ledgers of a program in place of the four reports'.
    #[must_use]
    #[track_caller]
    pub fn claims(mut self, name: &str, text: &str) -> Self {
        let taken = self.claims.iter().any(|(known, _)| known == name);
        self.note("claims", name, taken, Location::caller());
        self.claims.push((name.to_string(), text.to_string()));
        self
    }

    fn is_subject(&self, name: &str) -> bool {
        self.scenes.names().any(|known| known == name) || self.workloads.iter().any(|known| known.name == name)
    }

    fn note(&mut self, kind: &'static str, name: &str, is_taken: bool, at: &'static Location<'static>) {
        if is_taken && self.problem.is_none() {
            let first = self.added.iter().find(|(_, known, _)| known == name);
            let owner = first.map_or_else(|| "pathmark itself".to_string(), |(_, _, at)| at.to_string());
            let problem = format!("is already used by {owner}; {at} adds it again");
            self.problem = Some(InputError::new(kind, name, problem).allowed("another name"));
        }
        self.added.push((kind, name.to_string(), at));
    }

    /// Whether the program added this name, such as a `strategy`.
    pub fn is_own(&self, kind: &str, name: &str) -> bool {
        self.added.iter().any(|(own, known, _)| *own == kind && known == name)
    }

    pub fn check(&self) -> Result<()> {
        self.problem.as_ref().map_or(Ok(()), |problem| Err(problem.clone().into()))
    }

    pub fn strategies(&self) -> &[Strategy] {
        &self.strategies
    }

    /// Returns the strategy that `text` names, and the parameter after the colon if there is one.
    pub fn strategy_named(&self, text: &str) -> Result<(Strategy, Option<String>)> {
        let (name, parameter) = match text.split_once(':') {
            Some((name, parameter)) => (name, Some(parameter.to_string())),
            None => (text, None),
        };
        let entry = self.strategies.iter().find(|entry| entry.name == name).copied().ok_or_else(|| {
            if let Some((_, feature)) = LEFT_OUT.iter().find(|(left_out, _)| *left_out == name) {
                return InputError::new("strategy", name, "is missing from this build")
                    .allowed(shell::build_with(feature));
            }
            let names: Vec<&str> = self.strategies.iter().map(|entry| entry.name).collect();
            InputError::new("strategy", name, "there is no strategy of that name").allowed(names.join(", "))
        })?;
        match entry.discipline(parameter.as_deref()) {
            Err(StrategyError::Parameter { allowed, .. }) => {
                Err(InputError::new("strategy", text, "has an invalid parameter").allowed(allowed).into())
            }
            _ => Ok((entry, parameter)),
        }
    }

    pub fn kernels(&self) -> &[KernelEntry] {
        &self.kernels
    }

    pub fn kernel_tables(&self) -> Tables<'_> {
        Tables { kernels: &self.kernels, estimators: &self.estimators }
    }

    pub fn estimators(&self) -> impl Iterator<Item = &EstimatorEntry> {
        ESTIMATORS.iter().chain(self.estimators.iter().map(CustomEstimator::entry))
    }

    pub fn workloads(&self) -> &[workload::Entry] {
        &self.workloads
    }

    pub fn workload_named(&self, name: &str) -> Option<&workload::Entry> {
        self.workloads.iter().find(|entry| entry.name == name)
    }

    pub fn scenes(&self) -> impl Iterator<Item = &str> {
        self.scenes.names()
    }

    pub fn load_scene(&self, name_or_path: &str) -> Result<Scene> {
        self.scenes.load(name_or_path)
    }

    /// Returns the name of the estimator that the scene sets, or of the default one. It reads only the scene's own
    /// text.
    pub fn scene_estimator(&self, name_or_path: &str) -> Result<String> {
        self.scenes.estimator_of(name_or_path)
    }

    pub fn own_claims(&self) -> &[(String, String)] {
        &self.claims
    }

    pub fn own_experiments(&self) -> &[(String, String)] {
        &self.experiments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::workload::Mandelbrot;
    use crate::kernel::{Planned, SCALAR, Spec, choose_among};
    use crate::scene::{SCENES, load};

    fn said(lab: &Lab) -> String {
        lab.check().err().map(|error| error.to_string()).unwrap_or_default()
    }

    #[test]
    fn names_that_are_taken_name_both_owners() {
        assert_eq!(said(&Lab::new().workload("mine", Mandelbrot)), "");
        let error = said(&Lab::new().workload("cornell", Mandelbrot));
        assert!(error.starts_with("workload = cornell: ") && error.contains("pathmark itself"), "{error}");
        let error = said(&Lab::new().scene("mine", "").workload("mine", Mandelbrot));
        assert_eq!(error.matches(file!()).count(), 2, "{error}");
        let error = said(&Lab::new().kernel(SCALAR));
        assert!(error.starts_with("kernel = scalar: "), "{error}");
        let error = said(&Lab::new().strategy(STRATEGIES[0]));
        assert!(error.starts_with(&format!("strategy = {}: ", STRATEGIES[0].name)), "{error}");
    }

    #[test]
    fn a_program_has_its_own_name_and_version() {
        let pathmark = concat!("Pathmark ", env!("CARGO_PKG_VERSION"));
        let program = |lab: Lab| lab.program().join(" ");
        assert_eq!(program(Lab::new().name("mypool").version("0.3.1")), format!("mypool 0.3.1 ({pathmark})"));
        assert_eq!(program(Lab::new().name("mypool")), format!("mypool ({pathmark})"));
        assert_eq!(program(Lab::new().name("pathmark")), pathmark.to_lowercase());
        assert!(Lab::new().is_pathmark() && !Lab::new().name("mypool").is_pathmark());
        assert!(!Lab::new().claims("mine", "").is_pathmark());
        // The name of the test program, which is not Pathmark itself.
        assert_eq!(program(Lab::new()), format!("{} ({pathmark})", shell::executable_name()));
    }

    #[test]
    fn every_name_means_one_thing() {
        let lab = Lab::new();
        for entry in lab.workloads() {
            assert!(!SCENES.iter().any(|(name, _)| *name == entry.name), "{}", entry.name);
        }
    }

    /// A kernel without code for a scene gives way to the scalar one, and the row says why. Errors name all kernels.
    #[test]
    fn custom_kernels_are_chosen_by_name() {
        let picky = KernelEntry::new("picky", "renders nothing", |_| Ok(Planned::Unsupported("everything")));
        let lab = Lab::new().kernel(picky);
        let scene = load("cornell").unwrap();
        let chosen = |kernel: &str| {
            let spec = Spec { kernel: kernel.into(), ..Spec::default() };
            choose_among(&scene, &spec, lab.kernel_tables()).map_err(|error| error.to_string())
        };
        let choice = chosen("picky").unwrap();
        assert_eq!((choice.plan.name(), choice.fallback), ("scalar", "everything"));
        assert_eq!(chosen("scalar").unwrap().fallback, "");
        for unknown in ["pick", "picky:1"] {
            let error = chosen(unknown).err().unwrap();
            assert!(error.contains("lanes, scalar, ") && error.contains(", picky"), "{error}");
        }
    }
}
