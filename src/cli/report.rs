//! `pathmark report DIR`: figures and page, drawn again from records.

use super::output::print;
use crate::error::Result;
use clap::Args;
use std::path::PathBuf;

/// `pathmark report out`
#[derive(Args)]
pub(super) struct Arguments {
    /// A folder that `reproduce` or `run` wrote
    folder: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let page = crate::report::write(&arguments.folder)?;
    print(&page.display().to_string())
}
