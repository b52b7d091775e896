//! Texts that a spreadsheet would evaluate when it opens `records.csv`.
//!
//! Names are keys: with a mark in front, other programs and older rows would no longer find them. Names that a
//! spreadsheet takes for formulas are therefore refused before a sweep starts. The texts of errors are no keys and get a
//! mark.

use super::{Cell, Definition};
use crate::error::{InputError, Result};
use std::borrow::Cow;

/// The characters with which a formula begins, and those that a spreadsheet skips before one (OWASP, "CSV injection").
const FIRST: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// Refuses the names of an experiment, its scenes and its other programs if a spreadsheet takes them for formulas.
pub(super) fn check_names(definition: &Definition, cells: &[Cell]) -> Result<()> {
    let check = |field: &str, name: &str, value: &str| -> Result<()> {
        if !name.starts_with(FIRST) {
            return Ok(());
        }
        let problem = "gives rows a name that a spreadsheet takes for a formula";
        let allowed = "names that do not begin with =, +, -, @ or a tab";
        Err(InputError::new(field, value, problem).allowed(allowed).into())
    };
    check("experiment", &definition.name, &definition.file)?;
    for cell in cells {
        // The key of a cell begins with the name of its scene.
        check("scene", &cell.id, &cell.settings.scene)?;
        let program = cell.external.as_ref().map_or("", |external| &external.name);
        check("name", program, program)?;
    }
    Ok(())
}

/// The text of an error as a spreadsheet shows it: after an apostrophe if it would be evaluated.
pub(super) fn as_text(error: &str) -> Cow<'_, str> {
    if error.starts_with(FIRST) { format!("'{error}").into() } else { error.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_marked_only_if_a_spreadsheet_would_evaluate_them() {
        for error in ["=1+1", "+1", "-1", "@a", "\t=1", "\r=1"] {
            assert_eq!(as_text(error), format!("'{error}"));
        }
        for error in ["", "1 = 2", "killed", "'=1"] {
            assert!(matches!(as_text(error), Cow::Borrowed(same) if same == error));
        }
    }
}
