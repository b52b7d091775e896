//! Imports that verbs share: arguments, errors, files, and words to the user.

pub(super) use crate::console::Console;
pub(super) use crate::console::output::{json_of, number, print, print_json};
pub(super) use crate::error::{Error, InputError, Result};
pub(super) use crate::experiment::Progress;
pub(super) use crate::files::{Files, create_folder};
pub(super) use crate::lab::Lab;
pub(super) use crate::measure::{Record, Settings, Setup};
pub(super) use crate::report::counted;
pub(super) use clap::{Args, Subcommand, ValueEnum};
pub(super) use serde::Serialize;
pub(super) use serde_json::{Value, json};
pub(super) use std::path::{Path, PathBuf};
pub(super) use std::sync::Arc;
