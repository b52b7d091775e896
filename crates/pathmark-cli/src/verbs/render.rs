//! `pathmark render SCENE`: one image.

use super::prelude::*;
use super::setting_options::SettingOptions;
use super::strict::Strict;
use super::{inspect, ranks, rounds, shard};
use crate::film::Shard;
use crate::image_io;
use crate::kernel::workload::WORKLOAD;
use crate::measure::{Outcome, TraceFile};

/// `pathmark render cornell --spp 64 -o box.png`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Samples per pixel [default: 16]
    #[arg(long, value_name = "N", conflicts_with_all = ["target_error", "time_limit"], help_heading = "Accuracy")]
    spp: Option<u32>,
    #[command(flatten, next_help_heading = "Accuracy")]
    rounds: rounds::Until,
    /// Adapt the samples per pixel of each tile of 16x16 pixels to its noise; --spp is the average
    #[arg(long, conflicts_with_all = ["target_error", "time_limit", "checkpoint"], help_heading = "Accuracy")]
    adaptive: bool,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 1, help_heading = "Image")]
    seed: u64,
    /// Image file: .png, .ppm and .bmp for viewing, .exr, .pfm and .hdr for linear radiance [default: SCENE.png]
    #[arg(short = 'o', long = "image", value_name = "FILE", help_heading = "Output")]
    image: Option<PathBuf>,
    #[command(flatten)]
    part: shard::Part,
    #[command(flatten)]
    ranks: ranks::Ranks,
    #[command(flatten)]
    axes: SettingOptions,
    /// Scale .png, .ppm and .bmp files so that the brightest channel of the image is 1; the radiance itself does not change
    #[arg(long, help_heading = "Output")]
    auto_exposure: bool,
    /// Write each job's worker, start and end: a .csv file for `pathmark inspect jobs` and `pathmark simulate`
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    trace: Option<PathBuf>,
    /// Print the record as one JSON object
    #[arg(long, help_heading = "Output")]
    json: bool,
    #[command(flatten, next_help_heading = "Output")]
    strict: Strict,
}

const DEFAULT_SPP: u32 = 16;

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let spp = arguments.spp.unwrap_or(DEFAULT_SPP);
    let setup = console.busy(&format!("reading {}", arguments.scene), || {
        let settings = arguments.axes.settings(lab, &arguments.scene, spp, arguments.seed)?;
        lab.prepare(Settings { adaptive: arguments.adaptive, ..settings })
    })?;
    if let Some(shard) = arguments.part.shard()? {
        return render_part(arguments, shard, setup, console);
    }
    let path = arguments.image.clone().unwrap_or_else(|| PathBuf::from(format!("{}.png", setup.name())));
    let spec = &setup.settings().spec;
    let format = image_io::check_picture(&path, spec.width, spec.height)?;
    setup.remarks().iter().for_each(|remark| console.note(remark));
    let mut files = Files::default();
    files.reads_scene(setup.files());
    let outputs = [("image", Some(&path)), ("trace", arguments.trace.as_ref()), arguments.rounds.output()];
    for (option, path) in outputs {
        path.map_or(Ok(()), |path| files.writes(option, path))?;
    }

    let mut clustered = None;
    let (setup, outcome) = if let Some(rule) = arguments.ranks.rule(lab)? {
        let rendered = arguments.ranks.render(&rule, setup, &arguments.rounds, spp, console)?;
        let Some((rendered, tally)) = rendered else { return Ok(()) };
        clustered = Some((rule, tally));
        rendered
    } else if arguments.rounds.is_multi_round() {
        rounds::render(&arguments.rounds, setup, spp, console, &mut |rounds, spp| rounds.extend_to(spp, None))?
    } else {
        console.busy(&format!("building {}", setup.name()), || setup.build())?;
        console.begin(&format!("{} at {spp} spp", setup.name()), setup.jobs() as u64);
        let watch = |done| console.advance(done);
        let outcome = setup.run(Some(&watch))?;
        console.end();
        (setup, outcome)
    };
    let image = outcome.film.image();
    let is_exposed = arguments.auto_exposure && !format.linear;
    let shown = if is_exposed { image_io::auto_exposed(&image, outcome.brightest) } else { image };
    image_io::write_with_notes(&path, &shown, &outcome.provenance(&setup).notes())?;
    if let Some(trace) = &arguments.trace {
        TraceFile::new(&setup, &outcome).write(trace)?;
    }

    let mut record = Record::new(&setup, &outcome);
    arguments.rounds.label(&mut record);
    if let Some((rule, tally)) = &clustered {
        tally.label(rule, &mut record);
    }
    for warning in &outcome.warnings {
        console.note(&format!("warning: {warning}"));
    }
    for sample in &outcome.invalid {
        console.note(&inspect::path::command(&arguments.scene, setup.settings(), *sample));
    }
    match (&clustered, arguments.json) {
        (Some((_, tally)), true) => print_json(&ranks::WithRecord { record: &record, tally })?,
        (None, true) => print_json(&record)?,
        _ => print(&format!("{}: {}", path.display(), summary(&record, &outcome)))?,
    }
    if let Some((rule, tally)) = clustered.filter(|_| !arguments.json) {
        print(&ranks::told(&rule, &tally))?;
    }
    arguments.strict.check(outcome.counts.invalid)
}

fn render_part(arguments: &Arguments, shard: Shard, setup: Setup, console: &Console) -> Result<()> {
    let path = arguments.image.as_deref().unwrap_or(Path::new("part"));
    if image_io::check_format(path).is_ok() {
        let problem = "is a picture format, but a part is not a picture";
        let error = InputError::new("image", path.display().to_string(), problem);
        return Err(error.allowed("another extension, as in part-1.film").into());
    }
    setup.remarks().iter().for_each(|remark| console.note(remark));
    let mut files = Files::default();
    files.reads_scene(setup.files());
    files.writes("image", path)?;
    let invalid = shard::render(shard, setup, path, arguments.json, console)?;
    arguments.strict.check(invalid)
}

fn summary(record: &Record, outcome: &Outcome) -> String {
    let Record { width, height, spp, estimator, effects, strategy, decomposition, .. } = record;
    // A workload has neither estimator nor effects, and traces no rays.
    let is_workload = record.kernel == WORKLOAD;
    let light = if is_workload { String::new() } else { format!(", {estimator}, effects {effects}") };
    let what = format!("{width}x{height}, {spp} spp{light}");
    let noise = record.estimated_rmse.map_or_else(String::new, |rmse| format!(", estimated RMSE {rmse:.3e}"));
    let checksum = outcome.checksum.as_ref().map_or_else(
        || format!("no checksum: {} gives different numbers in each run", record.sampler),
        |checksum| format!("checksum {checksum}"),
    );
    let rendered = outcome.rendered();
    let (paths, rays) = (rendered.paths as f64, rendered.rays as f64);
    let makespan_s = outcome.makespan_s;
    let how = if outcome.rounds == 0 {
        "nothing was left to render".to_string()
    } else {
        let (speed, length) = (paths / makespan_s * 1e-6, rays / paths);
        let workers = counted(outcome.workers_used as usize, "worker");
        format!(
            "{strategy} on {decomposition}, {workers}: {makespan_s:.3} s, {speed:.3} Msamples/s{}",
            if is_workload { String::new() } else { format!(", {length:.2} rays per sample") }
        )
    };
    let lines = [format!("{what}{noise}"), how].into_iter().chain(outcome.remarks.iter().cloned()).chain([checksum]);
    lines.collect::<Vec<_>>().join("\n")
}
