//! `pathmark explain [WARNING]`: the meaning of a row's warnings.

use crate::console::output::print;
use crate::error::{InputError, Result};
use crate::measure::{WARNINGS, WarningEntry};
use clap::Args;

/// `pathmark explain drift`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A warning as it stands in a row, with or without its brackets [default: all]
    warning: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let Some(asked) = &arguments.warning else {
        return print(&WARNINGS.iter().map(explained).collect::<Vec<_>>().join("\n\n"));
    };
    // In rows, the numbers of the case follow the name in brackets.
    let name = asked.split('(').next().unwrap_or_default().trim();
    if let Some(entry) = WARNINGS.iter().find(|entry| entry.name == name) {
        return print(&explained(entry));
    }
    let names: Vec<&str> = WARNINGS.iter().map(|entry| entry.name).collect();
    Err(InputError::new("warning", asked, "there is no warning of that name").allowed(names.join(", ")).into())
}

fn explained(entry: &WarningEntry) -> String {
    format!("{}\n  {}\n  {}", entry.name, entry.about, entry.advice)
}
