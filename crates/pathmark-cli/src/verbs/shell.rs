//! `pathmark shell WHAT`: texts for the user's shell, made from the command line's description.

use super::prelude::*;
use crate::console::output::print_verbatim;
use crate::described;
use crate::shell::executable_name;

#[derive(Subcommand)]
pub(crate) enum Shell {
    /// Print a completion script for a shell.
    Completions(Completions),
    /// Print a manual page.
    Man(Man),
}

/// `pathmark shell completions bash > /etc/bash_completion.d/pathmark`
#[derive(Args)]
pub(crate) struct Completions {
    /// The shell
    shell: clap_complete::Shell,
}

/// `pathmark shell man render | man -l -`
#[derive(Args)]
pub(crate) struct Man {
    /// A verb, as in render or inspect path [default: the program as a whole]
    verb: Vec<String>,
}

impl Shell {
    pub(super) fn run(self) -> Result<()> {
        let mut text = Vec::new();
        match self {
            Self::Completions(Completions { shell }) => {
                clap_complete::generate(shell, &mut described(), executable_name(), &mut text);
            }
            Self::Man(Man { verb }) => {
                let page = clap_mangen::Man::new(described_verb(&verb)?);
                page.render(&mut text).map_err(|e| Error::system("writing", "the manual page", e))?;
            }
        }
        print_verbatim(String::from_utf8_lossy(&text).trim_end())
    }
}

/// The description of a verb, or of the program if none is named.
fn described_verb(names: &[String]) -> Result<clap::Command> {
    let mut command = described();
    for name in names {
        let verbs: Vec<_> = command.get_subcommands().filter(|command| !command.is_hide_set()).collect();
        let Some(found) = verbs.iter().find(|command| command.get_name() == name) else {
            let known: Vec<&str> = verbs.iter().map(|command| command.get_name()).collect();
            return Err(InputError::new("verb", name, "there is no such verb").allowed(known.join(", ")).into());
        };
        command = (*found).clone().bin_name(format!("{} {}", executable_name(), names.join(" ")));
    }
    Ok(command)
}
