//! The options that choose what is rendered, in which pieces and by whom.

use crate::error::{Error, InputError, Result};
use crate::input::{locate, read_text};
use crate::kernel::{Clamp, Spec};
use crate::lab::Lab;
use crate::measure::{LARGEST_SEED, Settings, THREAD_PER_ROW, available_threads};
use clap::Args;
use std::path::Path;

/// *What* is rendered.
#[derive(Args)]
pub(super) struct What {
    /// Columns and rows.
    #[arg(long, value_name = "WxH", default_value = "512x384", allow_hyphen_values = true)]
    pub(super) size: String,
    /// Estimator [default: the scene's own]
    #[arg(long, value_name = "NAME")]
    pub(super) estimator: Option<String>,
    /// Sampler
    #[arg(long, value_name = "NAME", default_value = "independent")]
    pub(super) sampler: String,
    /// Kernel
    #[arg(long, value_name = "NAME", default_value = "lanes")]
    pub(super) kernel: String,
    /// Instruction set of lanes: one of `pathmark list simd` [default: the fastest of this processor]
    #[arg(long, value_name = "LEVEL")]
    pub(super) simd: Option<String>,
    /// Floating-point format: f64, or f32, which lanes alone have and which gives other bits
    #[arg(long, value_name = "FORMAT", default_value = "f64")]
    pub(super) precision: String,
    /// Effect profile [default: the smallest that covers the scene]
    #[arg(long, value_name = "PROFILE")]
    pub(super) effects: Option<String>,
    /// What finds the nearest surface [default: the fitting one for so many]
    #[arg(long, value_name = "NAME")]
    pub(super) accelerator: Option<String>,
    /// Cut paths after so many bounces; 0 leaves what is seen directly [default: the estimator's own limit, if it has one]
    #[arg(long, value_name = "N")]
    pub(super) max_depth: Option<u16>,
    /// How chance ends paths: albedo:N or throughput:N behind the N-th vertex, or never [default: the estimator's own]
    #[arg(long, value_name = "RULE")]
    pub(super) roulette: Option<String>,
}

/// The three axes: *what*, *pieces*, *who*.
#[derive(Args)]
pub(super) struct Axes {
    #[command(flatten)]
    what: What,
    /// Who renders: a strategy of `pathmark list strategies`, or thread-per-row
    #[arg(long, value_name = "NAME", default_value = "work-stealing")]
    pub(super) strategy: String,
    /// Workers [default: one for each processor]
    #[arg(long, value_name = "N")]
    pub(super) threads: Option<usize>,
    /// Pieces: rows, bands:N, grid:N, tiles:WxH[:hilbert|:spiral|:cost], `samples:B[:WxH]` [default: tiles:32x32]
    #[arg(long, value_name = "CUT")]
    pub(super) decomposition: Option<String>,
    /// How pieces get into the film: an output of `pathmark list outputs`
    #[arg(long, value_name = "NAME", default_value = "slots")]
    pub(super) output: String,
    /// Clamp each subpixel's mean to 1 before averaging, as smallpt does: biased
    #[arg(long)]
    pub(super) subpixel_clamp: bool,
    /// Clamp the light that each recursion returns to 1, as report B does: biased
    #[arg(long, conflicts_with = "subpixel_clamp")]
    pub(super) recursion_clamp: bool,
}

/// Columns and rows from `WxH`.
pub(super) fn parse_size(text: &str) -> Result<(u32, u32)> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed.ok_or_else(|| InputError::new("size", text, "is no size").allowed("WxH, like 1024x768").into())
}

/// The refusal to look into the paths of a workload.
pub(super) fn no_paths(workload: &str) -> Error {
    InputError::new("scene", workload, "is a workload, and has no paths").allowed("a scene").into()
}

/// The estimator that a scene names; `scene` itself is a layer below estimators and cannot know whether there is one.
fn default_estimator(lab: &Lab, scene: &str) -> Result<Option<String>> {
    let name = lab.load_scene(scene)?.default_estimator;
    match name.as_deref().filter(|name| !lab.estimators().any(|entry| entry.name == *name)) {
        None => Ok(name),
        Some(unknown) => {
            let names: Vec<&str> = lab.estimators().map(|entry| entry.name).collect();
            let at = read_text(Path::new(scene)).ok().and_then(|text| locate(&text, "estimator", unknown));
            let error = InputError::new("estimator", unknown, "there is none of that name");
            Err(error.allowed(names.join(", ")).in_file(scene, at).into())
        }
    }
}

impl What {
    /// The kernel for a scene, and a seed that belongs to an image, not to a reference.
    fn spec(&self, lab: &Lab, scene: &str, seed: u64) -> Result<Spec> {
        let (width, height) = parse_size(&self.size)?;
        if seed > LARGEST_SEED {
            let problem = "belongs to the references";
            return Err(InputError::new("seed", seed.to_string(), problem)
                .allowed(format!("0 to {LARGEST_SEED}"))
                .into());
        }
        let default = Spec::default();
        let is_workload = lab.workload_named(scene).is_some();
        if is_workload {
            self.check_for_workload(scene, &default)?;
        }
        let estimator = match &self.estimator {
            Some(estimator) => estimator.clone(),
            None if is_workload => String::new(),
            None => default_estimator(lab, scene)?.unwrap_or(default.estimator),
        };
        Ok(Spec {
            width,
            height,
            seed,
            estimator,
            sampler: self.sampler.clone(),
            kernel: self.kernel.clone(),
            simd: self.simd.clone(),
            precision: self.precision.clone(),
            effects: self.effects.clone(),
            accelerator: self.accelerator.clone(),
            max_depth: self.max_depth,
            roulette: self.roulette.clone(),
            clamp: None,
        })
    }

    /// Refuses options that a workload, which has nothing to do with light, would not look at.
    fn check_for_workload(&self, workload: &str, default: &Spec) -> Result<()> {
        let unless_default = |value: &String, default: &String| Some(value.clone()).filter(|value| value != default);
        let options = [
            ("estimator", self.estimator.clone()),
            ("sampler", unless_default(&self.sampler, &default.sampler)),
            ("kernel", unless_default(&self.kernel, &default.kernel)),
            ("simd", self.simd.clone()),
            ("precision", unless_default(&self.precision, &default.precision)),
            ("effects", self.effects.clone()),
            ("accelerator", self.accelerator.clone()),
            ("max-depth", self.max_depth.map(|depth| depth.to_string())),
            ("roulette", self.roulette.clone()),
        ];
        match options.into_iter().find_map(|(option, value)| Some((option, value?))) {
            None => Ok(()),
            Some((option, value)) => {
                let problem = format!("has no meaning for {workload}, which is a workload");
                Err(InputError::new(option, value, problem).allowed("none").into())
            }
        }
    }

    /// Settings under which samples are looked into, by nobody in particular.
    pub(super) fn settings(&self, lab: &Lab, scene: &str, spp: u32, seed: u64) -> Result<Settings> {
        let spec = self.spec(lab, scene, seed)?;
        Ok(Settings { scene: scene.to_string(), spp, spec, ..Settings::default() })
    }
}

impl Axes {
    /// The decomposition; a strategy whose name says its pieces takes no other.
    fn cut(&self) -> Result<String> {
        match &self.decomposition {
            Some(cut) if self.strategy == THREAD_PER_ROW && cut != "rows" => {
                let problem = format!("contradicts the strategy {THREAD_PER_ROW}");
                Err(InputError::new("decomposition", cut, problem).allowed("rows, or none").into())
            }
            Some(cut) => Ok(cut.clone()),
            None => Ok("tiles:32x32".to_string()),
        }
    }

    /// The settings for a scene, samples and a seed.
    pub(super) fn settings(&self, lab: &Lab, scene: &str, spp: u32, seed: u64) -> Result<Settings> {
        let clamp = match (self.subpixel_clamp, self.recursion_clamp) {
            (true, _) => Some(Clamp::Subpixel),
            (false, true) => Some(Clamp::Recursion),
            (false, false) => None,
        };
        let spec = Spec { clamp, ..self.what.spec(lab, scene, seed)? };
        Ok(Settings {
            scene: scene.to_string(),
            spp,
            spec,
            decomposition: self.cut()?,
            output: self.output.clone(),
            strategy: self.strategy.clone(),
            threads: self.threads.unwrap_or_else(available_threads),
        })
    }
}
