//! The table of settings, by which the command line, experiments, filters, cell ids and figures know them.

use super::Settings;
use super::keys::{ImageKey, ScheduleKey};
use super::list::settings_list;
use super::value::{Field, Value};
use crate::error::{InputError, Result};
use crate::lab::Lab;
use crate::scene::FILTERS;
use crate::simd::{Level, levels};
use std::iter::once;
use std::sync::LazyLock;

/// One setting.
#[derive(Clone, Copy)]
pub struct Setting {
    /// Its name as an option, in an experiment, in a filter and in errors.
    pub name: &'static str,
    /// Whether another value gives another image. Every other setting changes only the schedule.
    pub changes_image: bool,
    /// Whether it applies to light alone, and not to a workload.
    pub of_light: bool,
    /// The name of its option's value in the help.
    pub value_name: &'static str,
    /// The help of its option; empty if the command line gives it in another way.
    pub about: &'static str,
    /// The value without the option; empty if it depends on the scene or the machine.
    pub default: &'static str,
    /// The values that an experiment means by `all`.
    pub all: Option<fn(&Lab) -> Vec<String>>,
    /// The field that holds its value.
    pub field: fn(&mut Settings) -> Field<'_>,
    /// Its label in figures where nothing was chosen.
    pub absent: &'static str,
    /// Its label in figures, with `{}` for the value; empty if figures name it in another way.
    label: &'static str,
    /// Its part of keys and cell ids, with `{}` for the value; empty for `/NAME-{}`.
    word: &'static str,
    /// The first version of the columns that has it.
    pub(crate) since: u32,
    /// Its place in the nesting of an experiment.
    nested: u8,
    is_size: bool,
    is_part: bool,
    column: &'static str,
    second_column: Option<&'static str>,
}

/// The properties in the list of settings.
impl Setting {
    /// A setting at this place of an experiment's nesting: those with smaller numbers vary more slowly.
    pub(crate) const fn nested(nested: u8) -> Self {
        Self {
            name: "",
            changes_image: false,
            of_light: false,
            value_name: "",
            about: "",
            default: "",
            all: None,
            field: |settings| settings.scene.field(),
            absent: "",
            label: "",
            word: "",
            since: 1,
            nested,
            is_size: false,
            is_part: false,
            column: "",
            second_column: None,
        }
    }

    /// A second column of the setting above.
    pub(crate) const fn part() -> Self {
        Self { is_part: true, ..Self::nested(0) }
    }

    pub(crate) const fn since(self, since: u32) -> Self {
        Self { since, ..self }
    }

    pub(crate) const fn light(self) -> Self {
        Self { of_light: true, ..self }
    }

    /// The setting of two numbers, which is named after both.
    pub(crate) const fn size(self) -> Self {
        Self { is_size: true, ..self }
    }

    pub(crate) const fn word(self, word: &'static str) -> Self {
        Self { word, ..self }
    }

    pub(crate) const fn label(self, label: &'static str, absent: &'static str) -> Self {
        Self { label, absent, ..self }
    }

    pub(crate) const fn all(self, all: fn(&Lab) -> Vec<String>) -> Self {
        Self { all: Some(all), ..self }
    }

    pub(crate) const fn option(self, value_name: &'static str, about: &'static str) -> Self {
        Self { value_name, about, ..self }
    }

    pub(crate) const fn default(self, default: &'static str) -> Self {
        Self { default, ..self }
    }

    pub(crate) fn scenes(lab: &Lab) -> Vec<String> {
        lab.scenes().map(str::to_string).collect()
    }

    pub(crate) fn levels(_: &Lab) -> Vec<String> {
        levels().map(Level::name).map(str::to_string).collect()
    }

    pub(crate) fn filters(_: &Lab) -> Vec<String> {
        FILTERS.iter().map(|entry| entry.name.to_string()).collect()
    }

    pub(crate) fn strategies(lab: &Lab) -> Vec<String> {
        lab.strategies().iter().map(|entry| entry.name.to_string()).collect()
    }
}

impl Setting {
    /// The setting of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SETTINGS.iter().find(|setting| setting.name == name)
    }

    /// The columns of a row that hold its value.
    pub fn columns(&self) -> impl Iterator<Item = &'static str> + use<> {
        once(self.column).chain(self.second_column)
    }

    /// Sets its value from text.
    pub fn set(&self, settings: &mut Settings, text: &str) -> Result<()> {
        match (self.field)(settings).set(text) {
            Some(()) => Ok(()),
            None if self.is_size => Err(not_a_size(text).into()),
            None => Err(InputError::new(self.name, text, "is out of range").into()),
        }
    }

    /// Its value as text; empty if it is left to the scene or the estimator.
    pub fn show(&self, settings: &Settings) -> String {
        (self.field)(&mut settings.clone()).show()
    }

    /// A column's part of keys and of cell ids.
    pub(super) fn word_of(&self, column: &str, text: &str) -> String {
        if self.word.is_empty() {
            return format!("/{}-{text}", column.replace('_', "-"));
        }
        self.word.replace("{}", text)
    }

    /// Whether figures name rows by it.
    pub fn is_label(&self) -> bool {
        !self.label.is_empty()
    }

    /// The name that figures give to its value; `None` if nothing was chosen.
    pub fn label_of(&self, image: &ImageKey, schedule: &ScheduleKey) -> Option<String> {
        let columns = if self.changes_image { image.columns() } else { schedule.columns() };
        let text = |wanted| columns.iter().find(|column| column.name == wanted).and_then(|column| column.text.clone());
        let own = text(self.column)?;
        let value = match self.second_column.filter(|_| self.is_size).and_then(text) {
            Some(height) => format!("{own}x{height}"),
            None => own,
        };
        Some(self.label.replace("{}", &value))
    }

    fn add_to(self, table: &mut Vec<Self>, column: &'static str, changes_image: bool, field: Option<Access>) {
        match (field, table.last_mut()) {
            (Some(field), _) if !self.is_part => {
                let size: Access = |settings| Field::Size(&mut settings.spec);
                let (name, field) =
                    if self.is_size { ("size", size) } else { (&*column.replace('_', "-").leak(), field) };
                table.push(Self { name, column, changes_image, field, ..self });
            }
            (_, above) => {
                if let Some(above) = above {
                    above.second_column = Some(column);
                }
            }
        }
    }
}

type Access = fn(&mut Settings) -> Field<'_>;

macro_rules! access {
    (own $field:ident) => {
        Some(|settings| settings.$field.field())
    };
    (spec $field:ident) => {
        Some(|settings| settings.spec.$field.field())
    };
    (found $field:ident) => {
        None
    };
}

macro_rules! fill {
    ([$table:ident] image $image:tt schedule $schedule:tt) => {
        fill! { $table true $image }
        fill! { $table false $schedule }
    };
    ($table:ident $changes_image:literal { $(
        $(#[doc = $about:literal])+ $place:ident $field:ident: $kind:ty $(= $default:expr)?, $setting:expr
        $(, when $when:meta)? $(, read $read:meta)?;
    )* }) => { $(
        $(#[$when])?
        $setting.add_to(&mut $table, stringify!($field), $changes_image, access!($place $field));
    )* };
}

/// Every setting, in the order in which an experiment nests them: the first varies slowest. Results on disk depend on
/// the order.
pub static SETTINGS: LazyLock<Vec<Setting>> = LazyLock::new(|| {
    let mut table = Vec::new();
    settings_list!(fill[table]);
    table.sort_by_key(|setting: &Setting| setting.nested);
    table
});

/// The columns of an image's identity. The scene's name and its hash are one setting.
pub fn image_columns() -> impl Iterator<Item = &'static str> {
    SETTINGS.iter().filter(|setting| setting.changes_image).flat_map(Setting::columns)
}

/// The columns of a schedule's identity. The kernel's name and the reason for it are one setting.
pub fn schedule_columns() -> impl Iterator<Item = &'static str> {
    SETTINGS.iter().filter(|setting| !setting.changes_image).flat_map(Setting::columns)
}

fn not_a_size(text: &str) -> InputError {
    InputError::new("size", text, "is not a size").allowed("WxH, for example 640x480")
}

/// Columns and rows from `WxH`.
pub fn parse_size(text: &str) -> Result<(u32, u32)> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed.ok_or_else(|| not_a_size(text).into())
}
