//! `pathmark merge PART...`: an image from the parts that `render --shard` made, or a sweep from those of `run --shard`.

use super::image::is_film;
use super::prelude::*;
use super::strict::Strict;
use crate::command_line;
use crate::experiment::{MergedSweep, merge_sweeps};
use crate::film_file::write_film;
use crate::image_io;
use crate::measure::{Provenance, merge};
use crate::report;

/// `pathmark merge part-*.film -o cornell.exr`, after `pathmark render cornell --shard 1/4 -o part-1.film` and so on
#[derive(Args)]
pub(crate) struct Arguments {
    /// The parts, in any order: files of `render --shard`, or folders of `run --shard`
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// The image: .png, .ppm and .bmp for viewing, .exr, .pfm and .hdr for linear radiance, .film for sums in full precision. For a
    /// sweep, the new folder
    #[arg(short = 'o', long, value_name = "FILE")]
    output: PathBuf,
    /// Merge even if parts are missing. Such an image equals no other render, so no checksum is printed
    #[arg(long)]
    partial: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    strict: Strict,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    if let Some(missing) = arguments.parts.iter().find(|part| !part.exists()) {
        let error = InputError::new("part", missing.display().to_string(), "there is no such file or folder");
        return Err(error.into());
    }
    if arguments.parts.iter().any(|part| part.is_dir()) {
        sweeps(arguments, lab, console)
    } else {
        image(arguments, console)
    }
}

fn sweeps(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    arguments.strict.refuse("applies to parts of an image; a sweep checks its rows when it measures them")?;
    let merged = merge_sweeps(&arguments.parts, &arguments.output, arguments.partial, &command_line())?;
    let mut outs: Vec<_> = merged.iter().map(|sweep| sweep.out.clone()).collect();
    outs.dedup();
    let (mut lines, mut sweeps) = (Vec::new(), Vec::new());
    for sweep in &merged {
        for part in &sweep.missing {
            console.note(&format!("warning: missing: part {part} of {}", sweep.name));
        }
        let folder = sweep.folder().display().to_string();
        lines.push(format!("{} rows in {folder}", sweep.rows));
        sweeps.push(json!({ "folder": folder, "rows": sweep.rows, "missing": sweep.missing }));
    }
    let mut reports = Vec::new();
    for out in outs {
        let report = report::write(lab, &out).inspect_err(|_| merged.iter().for_each(MergedSweep::remove))?;
        reports.push(report.display().to_string());
    }
    if arguments.json {
        return print_json(&json!({ "sweeps": sweeps, "reports": reports }));
    }
    lines.extend(reports.iter().map(|report| format!("report in {report}")));
    print(&lines.join("\n"))
}

fn image(arguments: &Arguments, console: &Console) -> Result<()> {
    let Arguments { parts, output, partial, .. } = arguments;
    let as_film = is_film(output);
    if !as_film {
        image_io::check_format(output)?;
    }
    let mut files = Files::default();
    for part in parts {
        files.reads("a part", part);
    }
    files.writes("output", output)?;
    let merged = merge(parts, *partial)?;
    let key = merged.key;
    let is_whole = merged.missing.is_empty();
    for part in &merged.missing {
        console.note(&format!("warning: missing: part {part}"));
    }
    if merged.invalid > 0 {
        console.note(&format!("warning: {} samples were NaN, infinite or negative", merged.invalid));
    }
    let checksum = is_whole.then(|| merged.film.checksum());
    if as_film {
        if !is_whole {
            let problem = "a film file needs the whole image, but parts are missing";
            return Err(InputError::new("output", output.display().to_string(), problem).allowed("a picture").into());
        }
        write_film(output, &key, &merged.film)?;
    } else {
        image_io::check_picture(output, key.width, key.height)?;
        let whole = is_whole.then(|| Provenance { key: key.clone(), checksum: checksum.clone() });
        let notes = whole.map_or_else(Vec::new, |film| film.notes());
        image_io::write_with_notes(output, &merged.film.image(), &notes)?;
    }
    if arguments.json {
        print_json(&json!({
            "image": output.display().to_string(), "parts": parts.len(), "of": merged.count, "missing": merged.missing,
            "film": key, "invalid": merged.invalid, "checksum": checksum,
        }))?;
    } else {
        let sum =
            checksum.map_or_else(|| "no checksum: parts are missing".to_string(), |sum| format!("checksum {sum}"));
        let (path, found, count) = (output.display(), parts.len(), merged.count);
        print(&format!("{path}: {}x{}, {} spp, {found} of {count} parts\n{sum}", key.width, key.height, key.spp))?;
    }
    arguments.strict.check(merged.invalid)
}
