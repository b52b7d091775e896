//! The options for the image, its pieces and the schedule, made from the table of axes.

use super::prelude::*;
use crate::input::{locate, read_text};
use crate::kernel::Spec;
use crate::measure::{Kind, LARGEST_SEED, SETTINGS, Setting, THREAD_PER_ROW};
use clap::builder::ValueParser;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Command, FromArgMatches, value_parser};

/// The values of the options for *what* is rendered, or of those for pieces and workers.
pub(super) struct Options<const WHAT: bool> {
    values: Vec<(&'static Setting, String)>,
}

/// The options for *what* is rendered.
pub(super) type What = Options<true>;

/// The three axes: *what*, *pieces*, *who*.
#[derive(Args)]
pub(super) struct SettingOptions {
    #[command(flatten)]
    what: What,
    #[command(flatten)]
    schedule: Options<false>,
    /// Clamp bright light: `subpixel` clamps the mean of each subpixel to 1, as smallpt does; `recursion` clamps the radiance that each
    /// recursion returns, as report B does; `recursion:10` clamps to 10. Biased
    #[arg(long, value_name = "CLAMP", help_heading = "Image")]
    pub(super) clamp: Option<String>,
}

/// The samples of an image whose paths a verb looks into.
#[derive(Args)]
pub(super) struct Samples {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    pub(super) scene: String,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 4)]
    pub(super) spp: u32,
    /// Seed of the image
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    what: What,
}

impl Samples {
    /// Reads their scene, and prints remarks about it. The schedule is the default one.
    pub(super) fn prepare(&self, lab: &Arc<Lab>, console: &Console) -> Result<Setup> {
        let setup = lab.prepare(self.what.settings(lab, &self.scene, self.spp, self.seed)?)?;
        setup.remarks().iter().for_each(|remark| console.note(remark));
        Ok(setup)
    }
}

/// The kernel for devices, and the option that chooses one.
const DEVICE: &str = "device";

fn device_option() -> Arg {
    let about = "Device of the kernel `device`: one of `pathmark list devices`, cuda:N, opencl:N or host [default: the first GPU]";
    Arg::new(DEVICE).long(DEVICE).value_name("ID").help(about).help_heading("Image")
}

/// The check that clap makes before the program reads a value.
fn parser(axis: &Setting) -> ValueParser {
    match axis.kind {
        Kind::Switch => value_parser!(bool),
        Kind::Count => value_parser!(u16).into(),
        Kind::Samples => value_parser!(u32).into(),
        Kind::Seconds => value_parser!(f64).into(),
        Kind::Seed => value_parser!(u64).into(),
        Kind::Workers => value_parser!(usize).into(),
        Kind::Name | Kind::Auto | Kind::Size => ValueParser::string(),
    }
}

impl<const WHAT: bool> Options<WHAT> {
    fn axes() -> impl Iterator<Item = &'static Setting> {
        SETTINGS.iter().filter(|axis| !axis.about.is_empty() && (axis.changes_image || axis.of_light) == WHAT)
    }

    fn value(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(axis, _)| axis.name == name).map(|(_, value)| value.as_str())
    }

    fn apply(&self, settings: &mut Settings) -> Result<()> {
        self.values.iter().try_for_each(|(axis, value)| axis.set(settings, value))
    }
}

impl<const WHAT: bool> Args for Options<WHAT> {
    fn augment_args(command: Command) -> Command {
        let command = if WHAT { command.arg(device_option()) } else { command };
        command.args(Self::axes().map(|axis| {
            let option = Arg::new(axis.name).long(axis.name).value_name(axis.value_name).help(axis.about);
            let option = option.help_heading(if WHAT { "Image" } else { "Schedule" });
            let option = option.value_parser(parser(axis)).allow_hyphen_values(axis.name == "size");
            let option = match axis.kind {
                // `--counters` alone means yes. A value needs `=`, because the next word may be the scene.
                Kind::Switch => option.num_args(0..=1).require_equals(true).default_missing_value("true"),
                _ => option,
            };
            if axis.default.is_empty() { option } else { option.default_value(axis.default) }
        }))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<const WHAT: bool> FromArgMatches for Options<WHAT> {
    fn from_arg_matches(matches: &ArgMatches) -> std::result::Result<Self, clap::Error> {
        let device = if WHAT { matches.get_one::<String>(DEVICE) } else { None };
        let given = |axis: &'static Setting| {
            let value = matches.get_raw(axis.name)?.next()?.to_str()?.to_string();
            let is_chosen = matches.value_source(axis.name) == Some(ValueSource::CommandLine);
            match device {
                // `--kernel device --device ID`, or `--device ID` alone, is the kernel `device:ID`.
                Some(id) if axis.name == "kernel" && (value == DEVICE || !is_chosen) => {
                    Some((axis, format!("{DEVICE}:{id}")))
                }
                _ => Some((axis, value)),
            }
        };
        let options = Self { values: Self::axes().filter_map(given).collect() };
        match (device, options.value("kernel")) {
            (Some(id), Some(kernel)) if !kernel.starts_with(DEVICE) => {
                let problem = format!("--device {id} requires the kernel {DEVICE}, but --kernel is {kernel}\n");
                Err(clap::Error::raw(ErrorKind::ArgumentConflict, problem))
            }
            _ => Ok(options),
        }
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> std::result::Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The error of a verb that needs paths, for a workload.
pub(super) fn no_paths(workload: &str) -> Error {
    InputError::new("scene", workload, "is a workload, which has no paths").allowed("a scene").into()
}

/// The estimator that a scene names. The layer `scene` lies below estimators, so the name is checked only here.
fn default_estimator(lab: &Lab, scene: &str) -> Result<String> {
    let name = lab.scene_estimator(scene)?;
    if lab.estimators().any(|entry| entry.name == name) {
        return Ok(name);
    }
    let names: Vec<&str> = lab.estimators().map(|entry| entry.name).collect();
    let at = read_text(Path::new(scene)).ok().and_then(|text| locate(&text, "estimator", &name));
    let error = InputError::new("estimator", name, "there is no such estimator");
    Err(error.allowed(names.join(", ")).in_file(scene, at).into())
}

/// Refuses options about light, which a workload would ignore.
fn check_for_workload(settings: &Settings) -> Result<()> {
    let mut base = Settings::default();
    base.spec.estimator.clear();
    let mut of_light = SETTINGS.iter().filter(|axis| axis.of_light);
    match of_light.find(|axis| axis.show(settings) != axis.show(&base)) {
        None => Ok(()),
        Some(axis) => {
            let (value, problem) =
                (axis.show(settings), format!("does not apply to {}, which is a workload", settings.scene));
            Err(InputError::new(axis.name, value, problem).allowed("no value").into())
        }
    }
}

impl What {
    /// Settings with these options, and with the default schedule.
    pub(super) fn settings(&self, lab: &Lab, scene: &str, spp: u32, seed: u64) -> Result<Settings> {
        let spec = Spec { seed, estimator: String::new(), ..Spec::default() };
        let mut settings = Settings { scene: scene.to_string(), spp, spec, ..Settings::default() };
        self.apply(&mut settings)?;
        if seed > LARGEST_SEED {
            let problem = "is reserved for references";
            return Err(InputError::new("seed", seed.to_string(), problem)
                .allowed(format!("0 to {LARGEST_SEED}"))
                .into());
        }
        if lab.workload_named(scene).is_some() {
            check_for_workload(&settings)?;
        } else if self.value("estimator").is_none() {
            settings.spec.estimator = default_estimator(lab, scene)?;
        }
        Ok(settings)
    }
}

impl SettingOptions {
    /// The settings for a scene, samples and a seed. Refuses other pieces for a strategy whose name gives its pieces.
    pub(super) fn settings(&self, lab: &Lab, scene: &str, spp: u32, seed: u64) -> Result<Settings> {
        let mut settings = self.what.settings(lab, scene, spp, seed)?;
        self.schedule.apply(&mut settings)?;
        settings.spec.clamp.clone_from(&self.clamp);
        if lab.workload_named(scene).is_some() {
            check_for_workload(&settings)?;
        }
        let cut = self.schedule.value("decomposition").filter(|cut| *cut != "rows");
        if let Some(cut) = cut.filter(|_| settings.strategy == THREAD_PER_ROW) {
            let problem = format!("contradicts the strategy {THREAD_PER_ROW}");
            return Err(InputError::new("decomposition", cut, problem).allowed("rows, or no value").into());
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_with_a_help_is_an_option_with_that_help() {
        let options = SettingOptions::augment_args(Command::new("render"));
        for setting in SETTINGS.iter().filter(|setting| !setting.about.is_empty()) {
            let option =
                options.get_arguments().find(|option| option.get_long() == Some(setting.name)).expect(setting.name);
            assert_eq!(option.get_help().map(ToString::to_string).as_deref(), Some(setting.about));
        }
    }
}
