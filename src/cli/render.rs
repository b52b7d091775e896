//! `pathmark render SCENE`: one image.

use super::axes::Axes;
use super::output::{print, print_json};
use super::progress::Talk;
use crate::atomic_file;
use crate::error::Result;
use crate::experiment::Progress;
use crate::image_io;
use crate::measure::{Measured, Record, Setup, TraceFile};
use clap::Args;
use std::path::PathBuf;

/// `pathmark render cornell --spp 64 -o box.png`
#[derive(Args)]
pub(super) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    spp: u32,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Image file: .png, .ppm and .bmp for looking at, .exr, .pfm and .hdr for linear radiance [default: SCENE.png]
    #[arg(short = 'o', long = "image", value_name = "FILE")]
    image: Option<PathBuf>,
    #[command(flatten)]
    axes: Axes,
    /// Scale what .png, .ppm and .bmp show so that the brightest channel of the image is 1; the light itself stays as it is
    #[arg(long)]
    auto_exposure: bool,
    /// Write who did what when: .csv for `pathmark trace` and `pathmark simulate`
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
    /// Print the record as one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments, talk: &Talk) -> Result<()> {
    let setup = Setup::prepare(arguments.axes.settings(&arguments.scene, arguments.spp, arguments.seed)?)?;
    let path = arguments.image.clone().unwrap_or_else(|| PathBuf::from(format!("{}.png", setup.scene().name)));
    let format = image_io::check_format(&path)?;
    atomic_file::check_writable(&path)?;
    if let Some(trace) = &arguments.trace {
        atomic_file::check_writable(trace)?;
    }

    talk.begin(&format!("{} at {} spp", setup.scene().name, arguments.spp), setup.jobs() as u64);
    let outcome = setup.run(Some(&|done| talk.advance(done)))?;
    talk.end();
    let image = outcome.film.image();
    let shown = if arguments.auto_exposure && !format.linear { image_io::auto_exposed(&image) } else { image };
    image_io::write(&path, &shown)?;
    if let Some(trace) = &arguments.trace {
        TraceFile::new(&setup, &outcome).write(trace)?;
    }

    let record = Record::new(&setup, &outcome, Measured::default());
    for warning in &outcome.warnings {
        talk.note(&format!("warning: {warning}"));
    }
    if arguments.json {
        return print_json(&record);
    }
    let (paths, rays) = (outcome.counts.paths as f64, outcome.counts.rays as f64);
    print(&format!(
        "{}: {}x{}, {} spp, {}, effects {}\n{} on {}, {} workers: {:.3} s, {:.3} Msamples/s, {:.2} rays per sample\n{}",
        path.display(),
        record.width,
        record.height,
        record.spp,
        record.estimator,
        record.effects,
        record.strategy,
        record.decomposition,
        outcome.workers_used,
        outcome.makespan_s,
        paths / outcome.makespan_s * 1e-6,
        rays / paths,
        outcome.checksum.as_ref().map_or_else(
            || format!("no checksum: {} gives other numbers in each run", record.sampler),
            |checksum| format!("checksum {checksum}")
        ),
    ))
}
