//! `pathmark report DIR`: figures and page, drawn again from records.

use crate::console::output::print;
use crate::error::Result;
use crate::files::Files;
use crate::lab::Lab;
use crate::report;
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// `pathmark report out`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A folder that `reproduce` or `run` wrote
    folder: PathBuf,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    report::claim("folder", &arguments.folder, &mut Files::default())?;
    let page = report::write(lab, &arguments.folder)?;
    print(&page.display().to_string())
}
