//! The table of axes: every setting that distinguishes one run from another, once.
//!
//! The command line, the matrix of an experiment, `--filter` and the ids of cells follow this table. A new axis is one row here, the
//! field that holds its value, and the code that uses it.

use super::Settings;
use crate::error::{InputError, Result};
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::scene::FILTERS;
use crate::simd::{Level, levels};
use Field::{Fitting, Name};

/// The field and the type of an axis's value.
pub enum Field<'a> {
    /// A name.
    Name(&'a mut String),
    /// A name, or a choice that fits the scene.
    Fitting(&'a mut Option<String>),
    /// Yes or no.
    Switch(&'a mut bool),
    /// A number, or none.
    Count(&'a mut Option<u16>),
    /// Samples per pixel.
    Samples(&'a mut u32),
    /// A seed.
    Seed(&'a mut u64),
    /// Workers.
    Workers(&'a mut usize),
    /// Columns and rows.
    Size(&'a mut Spec),
}

/// One axis.
pub struct Axis {
    /// Its name as an option, in an experiment, in a filter and in errors.
    pub name: &'static str,
    /// Whether another value gives another image. Every other axis changes only the schedule.
    pub changes_image: bool,
    /// Whether it applies to light alone, and not to a workload.
    pub of_light: bool,
    /// The name of its option's value in the help.
    pub value_name: &'static str,
    /// The help of its option; empty if the command line sets the axis in another way.
    pub about: &'static str,
    /// The value without the option; empty if it depends on the scene or the machine.
    pub default: &'static str,
    /// The values that an experiment means by `all`.
    pub all: Option<fn(&Lab) -> Vec<String>>,
    /// The field that holds its value.
    pub field: fn(&mut Settings) -> Field<'_>,
}

impl Axis {
    const fn new(name: &'static str, field: fn(&mut Settings) -> Field<'_>) -> Self {
        let (value_name, about, default) = ("", "", "");
        Self { name, changes_image: false, of_light: false, value_name, about, default, all: None, field }
    }

    const fn image(self) -> Self {
        Self { changes_image: true, ..self }
    }

    const fn light(self) -> Self {
        Self { of_light: true, ..self }
    }

    const fn all(self, all: fn(&Lab) -> Vec<String>) -> Self {
        Self { all: Some(all), ..self }
    }

    const fn option(self, value_name: &'static str, about: &'static str) -> Self {
        Self { value_name, about, ..self }
    }

    const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }

    /// The axis of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        AXES.iter().find(|axis| axis.name == name)
    }

    /// The columns of a row that hold its value.
    pub(super) fn columns(&self) -> Vec<String> {
        if self.name == "size" { vec!["width".into(), "height".into()] } else { vec![self.name.replace('-', "_")] }
    }

    /// Sets its value from text.
    pub fn set(&self, settings: &mut Settings, text: &str) -> Result<()> {
        match (self.field)(settings).set(text) {
            Some(()) => Ok(()),
            None if self.name == "size" => Err(not_a_size(text).into()),
            None => Err(InputError::new(self.name, text, "is out of range").into()),
        }
    }

    /// Its value as text; empty if it is left to the scene or the estimator.
    pub fn show(&self, settings: &Settings) -> String {
        (self.field)(&mut settings.clone()).show()
    }
}

fn not_a_size(text: &str) -> InputError {
    InputError::new("size", text, "is not a size").allowed("WxH, for example 640x480")
}

/// Columns and rows from `WxH`.
pub fn parse_size(text: &str) -> Result<(u32, u32)> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed.ok_or_else(|| not_a_size(text).into())
}

impl Field<'_> {
    fn set(self, text: &str) -> Option<()> {
        match self {
            Self::Name(name) => *name = text.to_string(),
            Self::Fitting(name) => *name = Some(text.to_string()),
            Self::Switch(switch) => *switch = text.parse().ok()?,
            Self::Count(count) => *count = Some(text.parse().ok()?),
            Self::Samples(spp) => *spp = text.parse().ok()?,
            Self::Seed(seed) => *seed = text.parse().ok()?,
            Self::Workers(threads) => *threads = text.parse().ok()?,
            Self::Size(spec) => (spec.width, spec.height) = parse_size(text).ok()?,
        }
        Some(())
    }

    fn show(self) -> String {
        match self {
            Self::Name(name) => name.clone(),
            Self::Fitting(name) => name.clone().unwrap_or_default(),
            Self::Switch(switch) => switch.to_string(),
            Self::Count(count) => count.map(|count| count.to_string()).unwrap_or_default(),
            Self::Samples(spp) => spp.to_string(),
            Self::Seed(seed) => seed.to_string(),
            Self::Workers(threads) => threads.to_string(),
            Self::Size(spec) => format!("{}x{}", spec.width, spec.height),
        }
    }
}

fn all_scenes(lab: &Lab) -> Vec<String> {
    lab.scenes().map(str::to_string).collect()
}

fn all_levels(_: &Lab) -> Vec<String> {
    levels().map(Level::name).map(str::to_string).collect()
}

fn all_filters(_: &Lab) -> Vec<String> {
    FILTERS.iter().map(|entry| entry.name.to_string()).collect()
}

fn all_strategies(lab: &Lab) -> Vec<String> {
    lab.strategies().iter().map(|entry| entry.name.to_string()).collect()
}

/// Every axis, in the order in which an experiment nests them: the first varies slowest. Results on disk depend on the order.
pub static AXES: [Axis; 24] = [
    Axis::new("scene", |s| Name(&mut s.scene)).image().all(all_scenes),
    Axis::new("size", |s| Field::Size(&mut s.spec)).image().option("WxH", "Width and height in pixels").default("512x384"),
    Axis::new("estimator", |s| Name(&mut s.spec.estimator)).image().light().option("NAME", "Estimator [default: the scene's own]"),
    Axis::new("sampler", |s| Name(&mut s.spec.sampler)).image().light().option("NAME", "Sampler").default("independent"),
    Axis::new("max-depth", |s| Field::Count(&mut s.spec.max_depth)).image().light().option("N", "Cut paths after N bounces; 0 keeps only directly visible light [default: the estimator's own limit, if it has one]"),
    Axis::new("camera-rays", |s| Field::Count(&mut s.spec.camera_rays)).image().light().option("N", "Camera rays per sample: their directly visible light is averaged, and the path continues from one of them [default: 1]"),
    Axis::new("spp", |s| Field::Samples(&mut s.spp)).image(),
    Axis::new("adaptive", |s| Field::Switch(&mut s.adaptive)).image().light(),
    Axis::new("seed", |s| Field::Seed(&mut s.spec.seed)).image(),
    Axis::new("clamp", |s| Fitting(&mut s.spec.clamp)).image().light(),
    Axis::new("filter", |s| Fitting(&mut s.spec.filter)).image().light().all(all_filters).option("NAME", "Pixel filter: tent, box or center [default: the camera's own]"),
    Axis::new("epsilon", |s| Fitting(&mut s.spec.epsilon)).image().light().option("DISTANCE", "Drop hits nearer than DISTANCE, as some programs do to exclude the surface where a ray starts: biased, scalar kernel only [default: none needed]"),
    Axis::new("kernel", |s| Name(&mut s.spec.kernel)).light().option("NAME", "Kernel: one of `pathmark list kernels`, `device` for the first GPU, or lanes+device:ID for lanes and a device together").default("lanes"),
    Axis::new("simd", |s| Fitting(&mut s.spec.simd)).light().all(all_levels).option("LEVEL", "Instruction set of lanes: one of `pathmark list simd` [default: the fastest that this processor supports]"),
    Axis::new("precision", |s| Name(&mut s.spec.precision)).image().light().option("FORMAT", "Floating-point format: f64, or f32, which produces different bits and does not work with the scalar kernel").default("f64"),
    Axis::new("effects", |s| Fitting(&mut s.spec.effects)).light().option("PROFILE", "Effect profile [default: the smallest that covers the scene]"),
    Axis::new("accelerator", |s| Fitting(&mut s.spec.accelerator)).light().option("NAME", "Acceleration structure [default: chosen by the number of primitives]"),
    Axis::new("roulette", |s| Fitting(&mut s.spec.roulette)).image().light().option("RULE", "Russian roulette rule: albedo:N or throughput:N after the N-th vertex, constant:P, or never [default: the estimator's own]"),
    Axis::new("strategy", |s| Name(&mut s.strategy)).all(all_strategies).option("NAME", "Scheduling strategy: one of `pathmark list strategies`, or thread-per-row").default("work-stealing"),
    Axis::new("threads", |s| Field::Workers(&mut s.threads)).option("N", "Worker threads [default: one per processor]"),
    Axis::new("decomposition", |s| Name(&mut s.decomposition)).option("CUT", "Decomposition into pieces: rows, bands:N, grid:N, tiles:WxH[:hilbert|:spiral|:cost], `samples:B[:WxH]` [default: tiles:32x32]"),
    Axis::new("output", |s| Name(&mut s.output)).option("NAME", "How workers deliver pieces to the film: one of `pathmark list outputs`").default("slots"),
    Axis::new("rank-rule", |s| Fitting(&mut s.rank_rule)),
    Axis::new("ranks", |s| Field::Count(&mut s.ranks)),
];
