//! The types of settings: what a user says, the column of a row that keeps it, and both as text.

use super::Seconds;
use super::table::{not_a_size, parse_size};
use crate::error::InputError;
use crate::kernel::Spec;
use crate::machine::PinPolicy;
use std::str::FromStr;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Name,
    /// A name, or a choice that fits the scene.
    Auto,
    Switch,
    Count,
    Samples,
    Seconds,
    Seed,
    Workers,
    Size,
}

pub(crate) trait Value {
    fn set(&mut self, text: &str) -> Option<()>;
    /// The error for a text that `set` refuses.
    fn refused(&self, name: &str, text: &str) -> InputError {
        InputError::new(name, text, "is out of range")
    }
    /// Empty if it is left to the scene or the estimator.
    fn show(&self) -> String;
}

/// A type of the list of settings.
pub trait Asked {
    /// Its type in a row and in keys.
    type Column;
    const COLUMN: &'static str;
    const KIND: Kind;

    fn column(&self) -> Self::Column;
    fn of(column: Self::Column) -> Self;
    /// A column as text; `None` if it is empty on purpose.
    fn text(column: &Self::Column) -> Option<String>;
}

/// A type that rows hold as it is, and its text there.
macro_rules! asked {
    ($type:ty, $kind:ident, $text:expr) => {
        impl Asked for $type {
            type Column = Self;
            const COLUMN: &'static str = stringify!($type);
            const KIND: Kind = Kind::$kind;

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
        }
    };
    ($($type:ty, $kind:ident, $text:expr;)*) => { $(
        asked!($type, $kind, $text);

        impl Value for $type {
            fn set(&mut self, text: &str) -> Option<()> {
                *self = text.parse().ok()?;
                Some(())
            }

            fn show(&self) -> String {
                self.to_string()
            }
        }
    )* };
}

asked! {
    String, Name, |name| Some(name.clone());
    bool, Switch, |switch| switch.then(|| switch.to_string());
    u32, Samples, |spp| Some(spp.to_string());
    u64, Seed, |seed| Some(seed.to_string());
    usize, Workers, |threads| Some(threads.to_string());
}

asked!(Option<u16>, Count, |count| count.map(|count| count.to_string()));
asked!(Option<Seconds>, Seconds, |limit| limit.map(|limit| limit.to_string()));

/// Rows keep the name that was chosen, or nothing.
impl Asked for Option<String> {
    type Column = String;
    const COLUMN: &'static str = "String";
    const KIND: Kind = Kind::Auto;

    fn column(&self) -> String {
        self.clone().unwrap_or_default()
    }

    fn of(column: String) -> Self {
        Some(column).filter(|name| !name.is_empty())
    }

    fn text(column: &String) -> Option<String> {
        Self::of(column.clone())
    }
}

impl<T: FromStr + ToString> Value for Option<T> {
    fn set(&mut self, text: &str) -> Option<()> {
        *self = Some(text.parse().ok()?);
        Some(())
    }

    fn show(&self) -> String {
        self.as_ref().map(ToString::to_string).unwrap_or_default()
    }
}

/// Rows keep nothing if workers were not pinned.
impl Asked for PinPolicy {
    type Column = String;
    const COLUMN: &'static str = "String";
    const KIND: Kind = Kind::Name;

    fn column(&self) -> String {
        if *self == Self::None { String::new() } else { self.to_string() }
    }

    fn of(column: String) -> Self {
        Self::parse(&column).unwrap_or_default()
    }

    fn text(column: &String) -> Option<String> {
        Some(column.clone()).filter(|policy| !policy.is_empty())
    }
}

impl Value for PinPolicy {
    fn set(&mut self, text: &str) -> Option<()> {
        *self = Self::parse(text)?;
        Some(())
    }

    fn refused(&self, _: &str, text: &str) -> InputError {
        Self::refused(text)
    }

    fn show(&self) -> String {
        self.to_string()
    }
}

impl Value for Spec {
    fn set(&mut self, text: &str) -> Option<()> {
        (self.width, self.height) = parse_size(text).ok()?;
        Some(())
    }

    fn refused(&self, _: &str, text: &str) -> InputError {
        not_a_size(text)
    }

    fn show(&self) -> String {
        format!("{}x{}", self.width, self.height)
    }
}
