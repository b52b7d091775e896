//! `pathmark merge PART...`: an image from the parts that `render --shard` made.

use super::output::{print, print_json};
use super::picture::is_film;
use super::progress::Talk;
use super::strict::Strict;
use crate::error::{InputError, Result};
use crate::experiment::Progress as _;
use crate::files::Files;
use crate::film_file::write_film;
use crate::image_io;
use crate::measure::{Provenance, merge};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// `pathmark merge part-*.film -o cornell.exr`, after `pathmark render cornell --shard 1/4 -o part-1.film` and so on
#[derive(Args)]
pub(super) struct Arguments {
    /// The parts, in any order
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// The image: .png, .ppm and .bmp for looking at, .exr, .pfm and .hdr for linear radiance, .film for sums in full precision
    #[arg(short = 'o', long, value_name = "FILE")]
    output: PathBuf,
    /// Make an image of the parts that there are. It is no other render's image: no checksum is printed
    #[arg(long)]
    partial: bool,
    /// Print the result as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    strict: Strict,
}

pub(super) fn run(arguments: &Arguments, talk: &Talk) -> Result<()> {
    let Arguments { parts, output, partial, .. } = arguments;
    let as_film = is_film(output);
    if !as_film {
        image_io::check_format(output)?;
    }
    let mut files = Files::default();
    parts.iter().for_each(|part| files.reads("a part", part));
    files.writes("output", output)?;
    let merged = merge(parts, *partial)?;
    let key = merged.key;
    let is_whole = merged.missing.is_empty();
    for part in &merged.missing {
        talk.note(&format!("warning: missing: part {part}"));
    }
    if merged.invalid > 0 {
        talk.note(&format!("warning: {} samples were NaN, infinite or negative", merged.invalid));
    }
    let checksum = is_whole.then(|| merged.film.checksum());
    if as_film {
        if !is_whole {
            let problem = "a film file is of a whole image, and parts are missing";
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
