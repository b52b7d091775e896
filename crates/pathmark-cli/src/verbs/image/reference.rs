//! `pathmark image reference SCENE`: the two half-references against which images are measured.

use crate::experiment::{Reference, ReferenceError, check_until, refine_reference, render_reference};
use crate::measure::parse_size;
use crate::verbs::prelude::*;

/// `pathmark image reference cornell --spp 4096 --size 256x192`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Samples per pixel of each half
    #[arg(long, value_name = "N", required_unless_present = "until", conflicts_with = "until")]
    spp: Option<u32>,
    /// Double both halves until the estimated RMSE of their average is at most this; continues from cached halves
    #[arg(long, value_name = "RMSE")]
    until: Option<f64>,
    /// Width and height in pixels
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

/// Samples per pixel at which refining starts.
const FIRST_SPP: u32 = 16;

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let (width, height) = parse_size(&arguments.size)?;
    let reference = Reference {
        scene: arguments.scene.clone(),
        version: None,
        estimator: arguments.estimator.clone(),
        sampler: arguments.sampler.clone(),
        size: [width, height],
        spp: arguments.spp.unwrap_or(FIRST_SPP),
    };
    arguments.until.map_or(Ok(()), check_until)?;
    reference.check(lab)?;
    reference.check_cache(lab, &arguments.out)?;
    let mut files = Files::default();
    let scene = lab.load_scene(&arguments.scene)?;
    files.reads_scene(&scene.files);
    scene.remarks_in(&scene.camera.view(width, height)).iter().for_each(|remark| console.note(remark));
    for path in reference.paths(lab, &arguments.out)? {
        files.claims("out", &path)?;
    }
    create_folder("out", &arguments.out)?;
    let halves = match arguments.until {
        Some(rmse) => refine_reference(lab, &reference, rmse, &arguments.out, console)?,
        None => render_reference(lab, &reference, &arguments.out, console)?,
    };
    let [(first, a), (second, b)] = &halves;
    print(&format!("{}\n{}\n{}", first.display(), second.display(), ReferenceError::of(a, b)))
}
