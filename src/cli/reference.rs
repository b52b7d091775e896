//! `pathmark reference SCENE`: the two half-references that images are measured against.

use super::axes::parse_size;
use super::output::print;
use super::progress::Talk;
use crate::error::{Error, Result};
use crate::experiment::{Reference, render_reference};
use clap::Args;
use std::path::PathBuf;

/// `pathmark reference cornell --spp 4096 --size 256x192`
#[derive(Args)]
pub(super) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Samples per pixel of each half
    #[arg(long, value_name = "N")]
    spp: u32,
    /// Columns and rows
    #[arg(long, value_name = "WxH", default_value = "512x384")]
    size: String,
    /// Estimator
    #[arg(long, value_name = "NAME", default_value = "bsdf")]
    estimator: String,
    /// Sampler
    #[arg(long, value_name = "NAME", default_value = "independent")]
    sampler: String,
    /// Folder for the two film files
    #[arg(long, value_name = "DIR", default_value = "out/references")]
    out: PathBuf,
}

pub(super) fn run(arguments: &Arguments, talk: &Talk) -> Result<()> {
    let (width, height) = parse_size(&arguments.size)?;
    let reference = Reference {
        scene: arguments.scene.clone(),
        estimator: arguments.estimator.clone(),
        sampler: arguments.sampler.clone(),
        size: [width, height],
        spp: arguments.spp,
    };
    reference.check()?;
    reference.check_cache(&arguments.out)?;
    std::fs::create_dir_all(&arguments.out).map_err(|e| Error::system("creating", &arguments.out, e))?;
    let [(first, a), (second, b)] = render_reference(&reference, &arguments.out, talk)?;
    // The variance of the average of two independent halves is a quarter of the sum of theirs.
    let noise = ((a.mean_variance() + b.mean_variance()) / 4.0).sqrt();
    print(&format!("{}\n{}\nestimated RMSE of their average: {noise:.3e}", first.display(), second.display()))
}
