//! `pathmark report DIR`: figures and page, drawn again from records.

use super::prelude::*;
use crate::report;

/// `pathmark report out`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A folder that `reproduce` or `run` wrote
    folder: PathBuf,
    /// Also write a page for each experiment, and a list of them, into the folder `pages`
    #[arg(long)]
    pages: bool,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    report::claim("folder", &arguments.folder, &mut Files::default())?;
    let page = if arguments.pages {
        report::write_pages("pages", lab, &arguments.folder)?
    } else {
        report::write(lab, &arguments.folder)?
    };
    print(&page.display().to_string())
}
