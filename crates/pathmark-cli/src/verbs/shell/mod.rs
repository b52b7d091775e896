//! `pathmark shell WHAT`: texts for the user's shell, made from the command line's description.

mod completions;
mod man;

use crate::error::Result;
use clap::Subcommand;

#[derive(Subcommand)]
pub(crate) enum Shell {
    /// Print a completion script for a shell.
    Completions(completions::Arguments),
    /// Print a manual page.
    Man(man::Arguments),
}

impl Shell {
    pub(super) fn run(self) -> Result<()> {
        match self {
            Self::Completions(arguments) => completions::run(&arguments),
            Self::Man(arguments) => man::run(&arguments),
        }
    }
}
