//! `pathmark report DIR`: figures and page, drawn again from records.

use super::prelude::*;
use crate::report;

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
