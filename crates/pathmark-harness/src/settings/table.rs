//! The table of settings, by which the command line, experiments, filters, cell ids and figures know them.

use super::Settings;
use super::keys::{ImageKey, ScheduleKey};
use super::list::settings_list;
use super::value::{Asked, Kind, Value};
use crate::error::{InputError, Result};
use crate::lab::Lab;
use crate::scene::FILTERS;
use crate::simd::{Level, levels};
use std::iter::once;
use std::sync::LazyLock;

const SIZE: &str = "size";

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
    pub kind: Kind,
    /// The values that an experiment means by `all`.
    pub all: Option<fn(&Lab) -> Vec<String>>,
    /// Its label in figures where nothing was chosen.
    pub absent: &'static str,
    /// Its label in figures, with `{}` for the value; empty if figures name it in another way.
    pub(crate) label: &'static str,
    /// Its part of keys and cell ids, with `{}` for the value; empty for `/NAME-{}`.
    pub(crate) word: &'static str,
    /// Its place in an experiment's nesting: settings with smaller numbers vary more slowly.
    pub(crate) nested: u8,
    /// Whether it is only a second column of the setting above.
    pub(crate) is_part: bool,
    pub(crate) field: Access,
    pub(crate) column: &'static str,
    pub(crate) second_column: Option<&'static str>,
}

pub(crate) type Access = fn(&mut Settings) -> &mut dyn Value;

impl Setting {
    pub(crate) const NEW: Self = Self {
        name: "",
        changes_image: false,
        of_light: false,
        value_name: "",
        about: "",
        default: "",
        kind: Kind::Name,
        all: None,
        absent: "",
        label: "",
        word: "",
        nested: 0,
        is_part: false,
        field: |settings| &mut settings.scene,
        column: "",
        second_column: None,
    };

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

    pub fn named(name: &str) -> Option<&'static Self> {
        SETTINGS.iter().find(|setting| setting.name == name)
    }

    pub fn columns(&self) -> impl Iterator<Item = &'static str> + use<> {
        once(self.column).chain(self.second_column)
    }

    pub fn set(&self, settings: &mut Settings, text: &str) -> Result<()> {
        let value = (self.field)(settings);
        value.set(text).ok_or_else(|| value.refused(self.name, text).into())
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

    pub fn is_label(&self) -> bool {
        !self.label.is_empty()
    }

    /// The name that figures give to its value; `None` if nothing was chosen.
    pub fn label_of(&self, image: &ImageKey, schedule: &ScheduleKey) -> Option<String> {
        self.found(image, schedule).map(|value| self.label.replace("{}", &value))
    }

    /// The value that was used, as text; `None` if there was none.
    pub(crate) fn found(&self, image: &ImageKey, schedule: &ScheduleKey) -> Option<String> {
        let columns = if self.changes_image { image.columns() } else { schedule.columns() };
        let text = |wanted| columns.iter().find(|column| column.name == wanted).and_then(|column| column.text.clone());
        let own = text(self.column)?;
        Some(match self.second_column.filter(|_| self.name == SIZE).and_then(text) {
            Some(height) => format!("{own}x{height}"),
            None => own,
        })
    }

    fn add_to(self, table: &mut Vec<Self>, column: &'static str, changes_image: bool, (kind, field): (Kind, Access)) {
        match table.last_mut().filter(|_| self.is_part) {
            Some(above) => above.second_column = Some(column),
            None if self.name == SIZE => {
                let field: Access = |settings| &mut settings.spec;
                table.push(Self { changes_image, kind: Kind::Size, field, column, ..self });
            }
            None => {
                let name = if self.name.is_empty() { column.replace('_', "-").leak() } else { self.name };
                table.push(Self { name, changes_image, kind, field, column, ..self });
            }
        }
    }
}

macro_rules! access {
    (own $field:ident) => {
        |settings| &mut settings.$field
    };
    (spec $field:ident) => {
        |settings| &mut settings.spec.$field
    };
    (found $field:ident) => {
        Setting::NEW.field
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
        $setting.add_to(&mut $table, stringify!($field), $changes_image, (<$kind as Asked>::KIND, access!($place $field)));
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

pub(super) fn not_a_size(text: &str) -> InputError {
    InputError::new(SIZE, text, "is not a size").allowed("WxH, for example 640x480")
}

/// Columns and rows from `WxH`.
pub fn parse_size(text: &str) -> Result<(u32, u32)> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed.ok_or_else(|| not_a_size(text).into())
}
