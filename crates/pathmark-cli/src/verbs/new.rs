//! `pathmark new experiment|scene|claims NAME`: a commented file to start from.

use super::prelude::*;
use crate::measure::utc_now;
use crate::shell;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};

/// `pathmark new experiment mine`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Kind of file
    kind: Kind,
    /// Its name or path; `.toml` is added if it is missing
    name: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Cells to measure and figures to draw, for `run`
    Experiment,
    /// A scene that overrides parts of another one, for `render`
    Scene,
    /// A ledger: claims of a paper, for `claims --ledger`
    Claims,
}

/// The time in the starter of a ledger.
const EXAMPLE: &str = "2026-01-31T12:00:00Z";

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let (text, verb) = match arguments.kind {
        Kind::Experiment => (include_str!("../../assets/starter-experiment.toml"), &["run"][..]),
        Kind::Scene => (include_str!("../../assets/starter-scene.toml"), &["render"][..]),
        Kind::Claims => (include_str!("../../assets/starter-claims.toml"), &["claims", "out", "--ledger"][..]),
    };
    let text = match utc_now() {
        // A clock without a date leaves the example.
        now if now.is_empty() => text.to_string(),
        now => text.replace(EXAMPLE, &now),
    };
    if arguments.name.file_name().is_none() || arguments.name.as_os_str().as_encoded_bytes().ends_with(b"/") {
        return Err(InputError::new("name", arguments.name.display().to_string(), "is not the name of a file").into());
    }
    let mut path = arguments.name.clone();
    if path.extension().is_none_or(|ending| ending != "toml") {
        path.as_mut_os_string().push(".toml");
    }
    let shown = path.display().to_string();
    // An existing file is never replaced.
    let mut file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|e| {
        let problem = match e.kind() {
            ErrorKind::AlreadyExists => "already exists",
            ErrorKind::NotFound => "its folder does not exist",
            ErrorKind::NotADirectory => "a part of the path is not a directory",
            ErrorKind::InvalidFilename => "the name is too long",
            _ => return Error::system("creating", &path, e),
        };
        InputError::new("name", &shown, problem).allowed("a new name in a folder that exists").into()
    })?;
    file.write_all(text.as_bytes()).map_err(|e| Error::system("writing", &path, e))?;
    print(&format!(
        "created {shown}; edit it, then run: {}",
        shell::command(verb.iter().copied().chain([shown.as_str()]))
    ))
}
