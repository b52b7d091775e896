//! `pathmark compare IMAGE REFERENCE`: how far an image is from another.

use super::output::{print, print_json};
use crate::atomic_file;
use crate::error::Result;
use crate::image_io;
use crate::metric::{METRICS, heatmap};
use clap::Args;
use std::path::PathBuf;

/// `pathmark compare box.pfm reference.exr --heatmap error.png`
#[derive(Args)]
pub(super) struct Arguments {
    /// The image
    image: PathBuf,
    /// What it is compared with
    reference: PathBuf,
    /// Write a picture of each pixel's error
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    if let Some(path) = &arguments.heatmap {
        image_io::check_format(path)?;
        atomic_file::check_writable(path)?;
    }
    let (image, reference) = (image_io::read(&arguments.image)?, image_io::read(&arguments.reference)?);
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
            values.iter().map(|(metric, value)| (metric.name.to_string(), serde_json::Value::from(*value))).collect();
        return print_json(&object);
    }
    let width = values.iter().map(|(metric, _)| metric.name.len()).max().unwrap_or(0);
    let lines: Vec<String> = values
        .iter()
        .map(|(metric, value)| format!("{:width$}  {value:<12.6}  {}", metric.name, metric.about))
        .collect();
    print(&lines.join("\n"))
}
