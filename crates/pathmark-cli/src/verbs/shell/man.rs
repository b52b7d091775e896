//! `pathmark shell man [VERB]`: a manual page, of the program or of a verb.

use crate::console::output::print_verbatim;
use crate::described;
use crate::error::{Error, InputError, Result};
use crate::shell;
use clap::Args;
use clap_mangen::Man;

/// `pathmark shell man render | man -l -`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A verb, as in render or inspect path [default: the program as a whole]
    verb: Vec<String>,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let mut command = described();
    for verb in &arguments.verb {
        let verbs: Vec<_> = command.get_subcommands().filter(|command| !command.is_hide_set()).collect();
        let Some(found) = verbs.iter().find(|command| command.get_name() == verb) else {
            let names: Vec<&str> = verbs.iter().map(|command| command.get_name()).collect();
            return Err(InputError::new("verb", verb, "there is no such verb").allowed(names.join(", ")).into());
        };
        command = (*found).clone().bin_name(format!("{} {}", shell::executable_name(), arguments.verb.join(" ")));
    }
    let mut page = Vec::new();
    Man::new(command).render(&mut page).map_err(|e| Error::system("writing", "the manual page", e))?;
    print_verbatim(String::from_utf8_lossy(&page).trim_end())
}
