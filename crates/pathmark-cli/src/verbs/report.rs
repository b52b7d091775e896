//! `pathmark report DIR`: figures and page, drawn again from records.

use super::prelude::*;
use crate::report::{self, Crop};

/// `pathmark report out`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A folder that `reproduce` or `run` wrote, or that of an experiment in it
    folder: PathBuf,
    /// Also draw the pictures of the figure `equal-time` with this square marked, and its pixels enlarged below: column and
    /// row of its top left pixel, and its width, as in 20,10,32. May be given several times
    #[arg(long, value_name = "X,Y,SIZE", allow_hyphen_values = true)]
    crops: Vec<String>,
    /// Also write a page for each experiment, and a list of them, into the folder `pages`
    #[arg(long)]
    pages: bool,
    /// Also write a new LaTeX file: figures, a table with intervals, machine, method and references
    #[arg(long, value_name = "FILE.tex")]
    paper: Option<PathBuf>,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let Arguments { folder, crops, pages, paper } = arguments;
    let crops = crops.iter().map(|crop| Crop::parse(crop)).collect::<Result<Vec<Crop>>>()?;
    let mut files = Files::default();
    report::claim("folder", folder, &mut files)?;
    if let Some(paper) = paper {
        files.writes("paper", paper)?;
        if paper.exists() {
            let error =
                InputError::new("paper", paper.display().to_string(), "already exists, and may have been edited");
            return Err(error.allowed("another file").into());
        }
    }
    let mut written = if crops.is_empty() { Vec::new() } else { report::write_crops(lab, folder, &crops)? };
    let page = if *pages { report::write_pages("pages", lab, folder)? } else { report::write_told(lab, folder)? };
    for reason in &page.left_out {
        console.note(&format!("warning: {reason}"));
    }
    written.insert(0, page.path);
    if let Some(paper) = paper {
        report::write_paper(lab, folder, paper)?;
        written.push(paper.clone());
    }
    let lines: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    print(&lines.join("\n"))
}
