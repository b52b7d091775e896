//! `pathmark inspect bounces SCENE`: the light of an image by number of bounces, and the lengths of its paths.

use crate::atomic_file;
use crate::kernel::{Inspector, LightByBounce, Spec};
use crate::plot::number::short;
use crate::verbs::prelude::*;
use crate::verbs::setting_options::{Samples, no_paths};
use std::fmt::Write;

/// `pathmark inspect bounces cornell --size 128x96 --spp 16`
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    samples: Samples,
    /// Write all rows
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Rows beyond this number are printed as one sum; files have all of them.
const SHOWN: usize = 16;

/// Report A says that Russian roulette ends paths before this number of bounces.
const REPORTED: usize = 6;

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let setup = arguments.samples.prepare(lab, console)?;
    let Some((scene, choice)) = setup.scene() else { return Err(no_paths(&arguments.samples.scene)) };
    let spec = &setup.settings().spec;
    let mut files = Files::default();
    files.reads_scene(setup.files());
    arguments.csv.as_ref().map_or(Ok(()), |path| files.writes("csv", path))?;
    let inspector = Inspector::new(scene, choice)?;
    console.begin(&format!("{} at {} spp", scene.name, arguments.samples.spp), u64::from(spec.height));
    let mut found = LightByBounce::default();
    for y in 0..spec.height {
        found.add(&LightByBounce::of(&inspector, spec.width, y..y + 1, &(0..arguments.samples.spp)));
        console.advance(u64::from(y) + 1);
    }
    console.end();
    if found.invalid > 0 {
        console.note(&format!("warning: {} samples had no valid radiance and are left out", found.invalid));
    }

    let rows = rows(&found);
    if let Some(path) = &arguments.csv {
        let head = "bounces,red,green,blue,share,running_share,ended,ended_share,running_ended_share\n";
        let text = rows.iter().fold(head.to_string(), |mut text, row| {
            let Row { bounces, light: [r, g, b], share, running, ended, ended_share, ended_running } = row;
            // Writing to a string does not fail.
            let _ = writeln!(text, "{bounces},{r},{g},{b},{share},{running},{ended},{ended_share},{ended_running}");
            text
        });
        atomic_file::write(path, |file| file.write_all(text.as_bytes()))?;
    }
    if arguments.json {
        return print_json(&json!({
            "scene": scene.name, "width": spec.width, "height": spec.height, "spp": arguments.samples.spp, "seed": spec.seed,
            "estimator": spec.estimator, "sampler": spec.sampler, "max_depth": choice.depth(),
            "camera_rays": choice.camera_rays(),
            "mean": total(&found).map(number), "samples": found.samples, "rays": found.rays, "invalid_samples": found.invalid,
            "parts": found.parts(), "mean_length": found.mean_length().map(number), "longest": found.longest(),
            "bounces": json_of(&rows)?,
        }));
    }
    print(&text(&scene.name, spec, arguments.samples.spp, &found, &rows))
}

/// Light and paths with one number of bounces.
#[derive(Serialize)]
struct Row {
    bounces: usize,
    /// Mean radiance.
    light: [f64; 3],
    /// Share of the light, all channels together.
    share: f64,
    #[serde(rename = "running_share")]
    running: f64,
    ended: u64,
    ended_share: f64,
    #[serde(rename = "running_ended_share")]
    ended_running: f64,
}

fn total(found: &LightByBounce) -> [f64; 3] {
    let mut total = [0.0; 3];
    for bounces in 0..found.rows.len() {
        for (sum, value) in total.iter_mut().zip(found.mean(bounces)) {
            *sum += value;
        }
    }
    total
}

fn rows(found: &LightByBounce) -> Vec<Row> {
    let whole: f64 = total(found).iter().sum();
    let share_of = |value: f64, whole: f64| if whole > 0.0 { value / whole } else { 0.0 };
    let (mut running, mut ended_running) = (0.0, 0.0);
    let rows = found.rows.iter().enumerate().map(|(bounces, row)| {
        let light = found.mean(bounces);
        let share = share_of(light.iter().sum(), whole);
        let ended_share = share_of(row.ended as f64, found.parts() as f64);
        running += share;
        ended_running += ended_share;
        Row { bounces, light, share, running, ended: row.ended, ended_share, ended_running }
    });
    rows.collect()
}

fn text(name: &str, spec: &Spec, spp: u32, found: &LightByBounce, rows: &[Row]) -> String {
    let percent = |share: f64| format!("{:.3}", 100.0 * share);
    let line = |bounces: String, row: &Row| {
        let light = row.light.map(|value| format!("{:>12}", short(value, 4))).join("");
        let shares = [row.share, row.running, row.ended_share, row.ended_running].map(percent);
        let [share, running, ended, ended_running] = shares;
        format!("{bounces:>7}{light}{share:>10}{running:>10}{ended:>10}{ended_running:>10}")
    };
    let Spec { width, height, seed, estimator, .. } = spec;
    let mut lines = vec![
        format!("{name}, {width}x{height}, {spp} spp, {estimator}, seed {seed}"),
        String::new(),
        format!("{:7}{:>36}{:>20}{:>20}", "", "mean radiance", "light, %", "paths that end, %"),
        format!(
            "{:>7}{:>12}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}",
            "bounces", "red", "green", "blue", "here", "so far", "here", "so far"
        ),
    ];
    let (shown, rest) = rows.split_at(rows.len().min(if rows.len() > SHOWN + 1 { SHOWN } else { rows.len() }));
    lines.extend(shown.iter().map(|row| line(row.bounces.to_string(), row)));
    if let (Some(first), Some(last)) = (rest.first(), rest.last()) {
        let sum = |value: &dyn Fn(&Row) -> f64| rest.iter().map(value).sum::<f64>();
        let light = std::array::from_fn(|channel| sum(&|row| row.light[channel]));
        let (share, ended_share) = (sum(&|row| row.share), sum(&|row| row.ended_share));
        lines.push(line(format!("{}+", first.bounces), &Row { light, share, ended_share, ..*last }));
    }
    let [r, g, b] = total(found);
    let before = rows.iter().take_while(|row| row.bounces < REPORTED).last().map_or(0.0, |row| row.ended_running);
    lines.push(String::new());
    lines.push(format!("mean radiance of the image {r} {g} {b}"));
    lines.push(format!(
        "{} paths, counting splits: {:.3} bounces on average, {} at most; {} % end before {REPORTED} bounces; {:.3} rays per sample",
        found.parts(),
        found.mean_length().unwrap_or(0.0),
        found.longest().unwrap_or(0),
        percent(before),
        found.rays as f64 / found.samples.max(1) as f64,
    ));
    lines.join("\n")
}
