//! `pathmark man [VERB]`: a manual page, of the program or of a verb.

use crate::console::output::print_verbatim;
use crate::described;
use crate::error::{Error, InputError, Result};
use crate::shell;
use clap::Args;
use clap_mangen::Man;

/// `pathmark man render | man -l -`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The verb [default: the program as a whole]
    verb: Option<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let program = described();
    let command = match &arguments.verb {
        None => program,
        Some(verb) => {
            let named = |command: &&clap::Command| command.get_name() == verb && !command.is_hide_set();
            let found = program.get_subcommands().find(named).cloned();
            let verbs = program.get_subcommands().filter(|command| !command.is_hide_set());
            let verbs: Vec<&str> = verbs.map(clap::Command::get_name).collect();
            let unknown = || InputError::new("verb", verb, "there is no such verb").allowed(verbs.join(", "));
            found.ok_or_else(unknown)?.bin_name(format!("{} {verb}", shell::executable_name()))
        }
    };
    let mut page = Vec::new();
    Man::new(command).render(&mut page).map_err(|e| Error::system("writing", "the manual page", e))?;
    print_verbatim(String::from_utf8_lossy(&page).trim_end())
}
