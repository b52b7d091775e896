//! `pathmark shell completions SHELL`: a script that completes verbs, options and their values.

use crate::console::output::print_verbatim;
use crate::described;
use crate::error::Result;
use crate::shell;
use clap::Args;
use clap_complete::Shell;

/// `pathmark shell completions bash > /etc/bash_completion.d/pathmark`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The shell
    shell: Shell,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut described(), shell::executable_name(), &mut script);
    print_verbatim(String::from_utf8_lossy(&script).trim_end())
}
