//! `pathmark inspect path SCENE`: one sample's path, bounce by bounce.

use crate::console::output::{self, aligned};
use crate::kernel::{self, Event, Inspector, PathLog, RenderOptions, Spec};
use crate::math::{Rgb, Vec3};
use crate::measure::{InvalidSample, LARGEST_SPP, SETTINGS, Setting};
use crate::plot::number;
use crate::scene::Scene;
use crate::shell;
use crate::simd::Precision;
use crate::verbs::prelude::*;
use crate::verbs::setting_options::{What, no_paths};

/// `pathmark inspect path cornell --pixel 300,250 --sample 3`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Column and row, from the top left
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pixel: String,
    /// Number of the pixel's sample, from 0
    #[arg(long, value_name = "K", default_value_t = 0)]
    sample: u32,
    /// Seed of the image
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    what: What,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    let sample = arguments.sample;
    if sample >= LARGEST_SPP {
        let problem = "exceeds the largest sample number";
        let allowed = format!("0 to {}", LARGEST_SPP - 1);
        return Err(InputError::new("sample", sample.to_string(), problem).allowed(allowed).into());
    }
    // Any number of samples that the estimator allows will do: only the names are used.
    let mut settings = arguments.what.settings(lab, &arguments.scene, 1, arguments.seed)?;
    let estimator = lab.estimators().find(|entry| entry.name == settings.spec.estimator);
    settings.spp = estimator.map_or(1, |entry| entry.spp_multiple);
    let setup = lab.prepare(settings)?;
    let Some((scene, choice)) = setup.scene() else { return Err(no_paths(&arguments.scene)) };
    let spec = &setup.settings().spec;
    let (x, y) = pixel(&arguments.pixel, spec)?;

    let (given, counts) = kernel::one_sample(&*choice.build(scene)?, [x, y], sample);
    let is_valid = counts.invalid == 0;
    let precision = choice.plan.precision();
    // Lanes keep no log, and only lanes have other precisions.
    let path = if precision == Precision::F64 { Some(path(scene, choice, (x, y, sample), given)?) } else { None };
    let radiance = path.as_ref().map_or(given, |(_, radiance)| radiance.channels());
    if arguments.json {
        let events = path.map(|(log, _)| log.events.iter().map(|event| object(scene, event)).collect::<Vec<Value>>());
        return print_json(&json!({
            "scene": scene.name, "width": spec.width, "height": spec.height, "seed": spec.seed,
            "estimator": spec.estimator, "sampler": spec.sampler, "max_depth": choice.depth(),
            "camera_rays": choice.camera_rays(),
            "roulette": choice.roulette().map(|rule| rule.to_string()), "precision": precision.name(),
            "pixel": [x, y], "sample": sample, "rays": counts.rays, "valid": is_valid,
            "radiance": radiance.map(output::number), "events": events,
        }));
    }
    let Spec { width, height, seed, estimator, .. } = spec;
    let what = path.map_or_else(
        || format!("{} is rendered by SIMD lanes only, which cannot report the events of a path.", precision.name()),
        |(log, _)| aligned(HEADS.map(String::from).to_vec(), lines(scene, &log.events), false),
    );
    let [r, g, b] = radiance;
    print(&format!(
        "{}, {width}x{height}, {estimator}, seed {seed}: pixel {x},{y}, sample {sample}\n\n{what}\n\nradiance {r} {g} {b}\n{}",
        scene.name,
        if is_valid {
            "The image receives this radiance, bit for bit."
        } else {
            "This radiance is invalid: the image receives nothing, and counts an invalid sample."
        },
    ))
}

/// Whether the setting is an option of this verb that changes the sample.
fn is_of_sample(setting: &Setting) -> bool {
    setting.changes_image && (!setting.about.is_empty() || setting.name == "seed")
}

/// The command that replays a sample of an image, with every option that changes the sample.
pub(in crate::verbs) fn command(scene: &str, settings: &Settings, at: InvalidSample) -> String {
    let told = SETTINGS.iter().filter(|setting| is_of_sample(setting));
    let values = told.map(|setting| (setting.name, setting.show(settings))).filter(|(_, value)| !value.is_empty());
    let options = values.flat_map(|(name, value)| [format!("--{name}"), value]);
    let place = ["--pixel".to_string(), format!("{},{}", at.x, at.y), "--sample".to_string(), at.sample.to_string()];
    shell::command(
        ["inspect".to_string(), "path".to_string(), scene.to_string()].into_iter().chain(options).chain(place),
    )
}

fn pixel(text: &str, spec: &Spec) -> Result<(u32, u32)> {
    let parsed = text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    let inside = parsed.filter(|(x, y)| *x < spec.width && *y < spec.height);
    inside.ok_or_else(|| {
        let problem = if parsed.is_some() { "is outside the image" } else { "is not a pixel" };
        let allowed = format!("X,Y from 0,0 to {},{}", spec.width - 1, spec.height - 1);
        InputError::new("pixel", text, problem).allowed(allowed).into()
    })
}

/// Traces the path again with a log, and checks that its radiance equals the kernel's bit for bit.
fn path(scene: &Arc<Scene>, choice: &RenderOptions, at: (u32, u32, u32), given: [f64; 3]) -> Result<(PathLog, Rgb)> {
    let mut log = PathLog::default();
    let radiance = Inspector::new(scene, choice)?.estimate(at.0, at.1, at.2, &mut log);
    let expected = if radiance.is_valid_radiance() { radiance } else { Rgb::BLACK };
    if given.map(f64::to_bits) == expected.channels().map(f64::to_bits) {
        return Ok((log, radiance));
    }
    Err(Error::Check(format!("the path gives {radiance:?}, but the image receives {given:?}")))
}

fn side(inside: bool) -> &'static str {
    if inside { "inside" } else { "outside" }
}

fn name(scene: &Scene, object: u32) -> &str {
    scene.objects.get(object as usize).map_or("", |object| &object.name)
}

fn object(scene: &Scene, event: &Event) -> Value {
    let numbers = |values: [f64; 3]| values.map(output::number);
    let vector = |v: Vec3| numbers([v.x, v.y, v.z]);
    match *event {
        Event::Surface { bounces, origin, hit, throughput } => json!({
            "event": "surface", "bounces": bounces, "object": name(scene, hit.object), "primitive": hit.primitive,
            "side": side(hit.inside), "distance": output::number(hit.t), "origin": vector(origin), "point": vector(hit.point),
            "normal": vector(hit.normal), "throughput": numbers(throughput.channels()),
        }),
        Event::Fog { bounces, origin, point, distance, throughput } => json!({
            "event": "fog", "bounces": bounces, "distance": output::number(distance), "origin": vector(origin),
            "point": vector(point), "throughput": numbers(throughput.channels()),
        }),
        Event::Light { bounces, radiance } => {
            json!({ "event": "light", "bounces": bounces, "radiance": numbers(radiance.channels()) })
        }
        Event::Split { bounces } => json!({ "event": "split", "bounces": bounces }),
        Event::Escaped => json!({ "event": "escaped" }),
        Event::Truncated => json!({ "event": "truncated" }),
        Event::Roulette => json!({ "event": "roulette" }),
        Event::Ended { bounces } => json!({ "event": "ended", "bounces": bounces }),
    }
}

/// The heads of the table.
const HEADS: [&str; 6] = ["bounces", "what", "distance", "point", "throughput", "light added"];

fn triple(values: [f64; 3]) -> String {
    values.map(|value| format!("{:>10}", number::short(value, 5))).join(" ")
}

fn lines(scene: &Scene, events: &[Event]) -> Vec<Vec<String>> {
    let mut lines: Vec<Vec<String>> = Vec::new();
    let mut why = "no further ray";
    let mut fresh_surface = false;
    // The first ray of the path comes before any other camera ray.
    let mut has_ended = false;
    let line = |bounces: u16, cells: [String; 5]| [bounces.to_string()].into_iter().chain(cells).collect::<Vec<_>>();
    let word = |bounces, text| line(bounces, [text, String::new(), String::new(), String::new(), String::new()]);
    for event in events {
        let stands_on_surface = std::mem::take(&mut fresh_surface);
        match *event {
            Event::Surface { bounces, hit, throughput, .. } => {
                let what = format!("{}, primitive {}, {}", name(scene, hit.object), hit.primitive, side(hit.inside));
                let point = triple([hit.point.x, hit.point.y, hit.point.z]);
                let (distance, throughput) = (number::short(hit.t, 6), triple(throughput.channels()));
                lines.push(line(bounces, [what, distance, point, throughput, String::new()]));
                fresh_surface = true;
            }
            Event::Fog { bounces, point, distance, throughput, .. } => {
                let (point, throughput) = (triple([point.x, point.y, point.z]), triple(throughput.channels()));
                let distance = number::short(distance, 6);
                lines.push(line(bounces, ["scattered by fog".into(), distance, point, throughput, String::new()]));
            }
            Event::Light { radiance, .. } if radiance.is_black() => {}
            // The light that a surface emits is logged right after the hit.
            Event::Light { radiance, .. } if stands_on_surface => {
                if let Some(own) = lines.last_mut() {
                    own[5] = triple(radiance.channels());
                }
            }
            Event::Light { bounces, radiance } => {
                let is_seen_besides = has_ended && bounces == 0;
                let mut own = word(bounces, if is_seen_besides { "other camera rays" } else { "light" }.into());
                own[5] = triple(radiance.channels());
                lines.push(own);
            }
            Event::Split { bounces } => lines.push(word(bounces, "splits: the other branch comes later".into())),
            Event::Escaped => why = "hit nothing",
            Event::Truncated => why = "cut at the bounce limit",
            Event::Roulette => why = "Russian roulette",
            Event::Ended { bounces } => {
                lines.push(word(bounces, format!("ends: {why}")));
                why = "no further ray";
                has_ended = true;
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Kind;
    use clap::Parser;

    #[derive(Parser)]
    struct Path {
        #[command(flatten)]
        arguments: Arguments,
    }

    /// The arguments that the program reads from a command.
    fn read(command: &str) -> Arguments {
        let (_, words) = command.split_once(" inspect ").expect("the program's name and the verb");
        Path::try_parse_from(words.split(' ')).expect("a command that the program takes").arguments
    }

    /// Changes each setting that changes a sample. Names need not exist: nothing looks them up.
    #[test]
    fn a_told_command_is_of_the_same_sample_with_every_setting() {
        let of = |told: Arguments| told.what.settings(&Lab::new(), &told.scene, 4, told.seed).unwrap();
        let base = || of(read("pathmark inspect path cornell --pixel 0,0"));
        let (told, left): (Vec<&Setting>, Vec<&Setting>) =
            SETTINGS.iter().filter(|setting| setting.changes_image).partition(|setting| is_of_sample(setting));
        let left: Vec<&str> = left.into_iter().map(|setting| setting.name).collect();
        assert_eq!(left, ["scene", "spp", "adaptive", "clamp", "time-limit"]);
        for setting in told {
            let mut settings = base();
            let value = match setting.kind {
                Kind::Size => "9x7",
                Kind::Name | Kind::Auto => "other",
                _ => "3",
            };
            setting.set(&mut settings, value).unwrap();
            assert_ne!(settings, base(), "{}", setting.name);
            let told = read(&command("cornell", &settings, InvalidSample { y: 5, x: 7, sample: 3 }));
            assert_eq!((told.scene.as_str(), told.pixel.as_str(), told.sample), ("cornell", "7,5", 3));
            assert_eq!(of(told), settings);
        }
        assert!(
            command("my scene.toml", &Settings::default(), InvalidSample { y: 0, x: 0, sample: 0 })
                .contains(" 'my scene.toml' ")
        );
    }
}
