//! `pathmark compare IMAGE REFERENCE`: how far an image is from another.

use super::output::{number, print, print_json};
use crate::error::{InputError, Result};
use crate::files::Files;
use crate::film_file::{FilmKey, read_film};
use crate::image_io::{self, Image};
use crate::metric::{METRICS, heatmap};
use clap::Args;
use std::path::{Path, PathBuf};

/// `pathmark compare box.pfm reference.exr --heatmap error.png`
#[derive(Args)]
pub(super) struct Arguments {
    /// The image: a picture or a film file
    image: PathBuf,
    /// What it is compared with, likewise
    reference: PathBuf,
    /// Write a picture of each pixel's error
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// A picture, and what it is of where its file knows.
fn read(path: &Path) -> Result<(Image, Option<FilmKey>)> {
    if path.extension().is_some_and(|extension| extension == "film") && path.is_file() {
        let (key, film) = read_film(path)?;
        return Ok((film.image(), Some(key)));
    }
    Ok((image_io::read(path)?, None))
}

/// Images of one scene and one seed share samples, and look more alike than they are.
fn check_independent(image: &FilmKey, reference: &FilmKey) -> Result<()> {
    if (&image.scene_hash, image.seed) != (&reference.scene_hash, reference.seed) {
        return Ok(());
    }
    let problem = "is the seed of both, so that they share samples and look more alike than they are";
    Err(InputError::new("seed", image.seed.to_string(), problem).allowed("two different seeds").into())
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    if let Some(path) = &arguments.heatmap {
        image_io::check_format(path)?;
        let mut files = Files::default();
        files.reads("the image", &arguments.image);
        files.reads("the reference", &arguments.reference);
        files.writes("heatmap", path)?;
    }
    let ((image, key), (reference, reference_key)) = (read(&arguments.image)?, read(&arguments.reference)?);
    if let (Some(key), Some(reference_key)) = (key, reference_key) {
        check_independent(&key, &reference_key)?;
    }
    let mut values = Vec::new();
    for metric in METRICS {
        values.push((metric, metric.compute(&image, &reference)?));
    }
    if let Some(path) = &arguments.heatmap {
        let map = heatmap(&image, &reference, None)?;
        image_io::write(path, &map.to_image())?;
    }
    if arguments.json {
        let object: serde_json::Map<String, serde_json::Value> =
            values.iter().map(|(metric, value)| (metric.name.to_string(), number(*value))).collect();
        return print_json(&object);
    }
    let width = values.iter().map(|(metric, _)| metric.name.len()).max().unwrap_or(0);
    let lines: Vec<String> = values
        .iter()
        .map(|(metric, value)| format!("{:width$}  {value:<12.6}  {}", metric.name, metric.about))
        .collect();
    print(&lines.join("\n"))
}
