//! `pathmark artifact DIR`: an archive of rows, claims and instructions for an artifact committee, or the check of one.

use super::prelude::*;
use crate::report::artifact::{CITATION, Citation, Request, check, write};
use crate::shell;

/// `pathmark artifact my-artifact out --ledger paper.toml`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The archive: a new or empty folder, or with `--check` one from elsewhere
    archive: PathBuf,
    /// Folders that `reproduce` or `run` wrote, each a run
    #[arg(default_value = "out", value_name = "DIR", conflicts_with = "check")]
    folders: Vec<PathBuf>,
    /// The claims: a ledger of your own, or a folder of ledgers [default: the four reports]
    #[arg(long, value_name = "FILE|DIR", conflicts_with = "check")]
    ledger: Option<PathBuf>,
    /// Title of the artifact [default: that in CITATION.cff of the current folder]
    #[arg(long, value_name = "TEXT", conflicts_with = "check")]
    title: Option<String>,
    /// Author, as in "Family, Given <0000-0002-1825-0097>" or as the name of an organization; may be given several times
    /// [default: those in CITATION.cff]
    #[arg(long = "author", value_name = "NAME", conflicts_with = "check")]
    authors: Vec<String>,
    /// Licence of the rows, as an SPDX identifier such as CC-BY-4.0 [default: those in CITATION.cff]
    #[arg(long, value_name = "SPDX", conflicts_with = "check")]
    license: Option<String>,
    /// Check an archive: files and checksums, citation, rows, and whether the rows give the stated verdicts
    #[arg(long)]
    check: bool,
    /// Print only the verdict on this claim
    #[arg(long, value_name = "ID", requires = "check")]
    claim: Option<u32>,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    let Arguments { archive, folders, ledger, title, authors, license, .. } = arguments;
    let shown = archive.display().to_string();
    if arguments.check {
        let checked = check(lab, archive, arguments.claim)?;
        print(&checked.verdicts.join("\n"))?;
        let (files, rows) = (counted(checked.files, "file"), checked.rows);
        return print(&format!("{shown}: {files} with their checksums, {rows}, all verdicts as stated"));
    }
    let citation = Citation::choose(title.as_deref(), authors, license.as_deref(), Path::new(CITATION))?;
    let request = Request { archive, folders, ledger: ledger.as_deref(), citation: &citation };
    let written = write(lab, &request)?;
    print(&format!(
        "{shown}: {}, {:.1} MB\nto check it: {}\nto pack it:  tar -czf {} {}",
        counted(written.files, "file"),
        written.bytes as f64 / 1e6,
        shell::command(["artifact", &shown, "--check"]),
        shell::quoted(&format!("{}.tar.gz", shown.trim_end_matches('/'))),
        shell::quoted(&shown)
    ))
}
