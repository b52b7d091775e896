//! The types of settings: what a user says, the column of a row that keeps it, and both as text.

use super::table::parse_size;
use crate::kernel::Spec;

/// The field and the type of a setting's value.
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

impl Field<'_> {
    pub(super) fn set(self, text: &str) -> Option<()> {
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

    pub(super) fn show(self) -> String {
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

/// A type of the list of settings.
pub trait Value {
    /// Its type in a row and in keys.
    type Column;
    /// The name of that type.
    const COLUMN: &'static str;

    fn column(&self) -> Self::Column;
    fn of(column: Self::Column) -> Self;
    /// A column as text; `None` if it is empty on purpose.
    fn text(column: &Self::Column) -> Option<String>;
    fn field(&mut self) -> Field<'_>;
}

/// Types that rows hold as they are.
macro_rules! value {
    ($kind:ty, $field:ident, $text:expr) => {
        impl Value for $kind {
            type Column = Self;
            const COLUMN: &'static str = stringify!($kind);

            fn column(&self) -> Self {
                self.clone()
            }

            fn of(column: Self) -> Self {
                column
            }

            fn text(column: &Self) -> Option<String> {
                let text: fn(&Self) -> Option<String> = $text;
                text(column)
            }

            fn field(&mut self) -> Field<'_> {
                Field::$field(self)
            }
        }
    };
}

value!(String, Name, |name| Some(name.clone()));
value!(bool, Switch, |switch| switch.then(|| switch.to_string()));
value!(Option<u16>, Count, |count| count.map(|count| count.to_string()));
value!(u32, Samples, |spp| Some(spp.to_string()));
value!(u64, Seed, |seed| Some(seed.to_string()));
value!(usize, Workers, |threads| Some(threads.to_string()));

/// Rows keep the name that was chosen, or nothing.
impl Value for Option<String> {
    type Column = String;
    const COLUMN: &'static str = "String";

    fn column(&self) -> String {
        self.clone().unwrap_or_default()
    }

    fn of(column: String) -> Self {
        Some(column).filter(|name| !name.is_empty())
    }

    fn text(column: &String) -> Option<String> {
        Self::of(column.clone())
    }

    fn field(&mut self) -> Field<'_> {
        Field::Fitting(self)
    }
}
