//! Inspection of samples: an inspected sample equals the one in the image, its path tells where its light comes from,
//! and light by bounces decomposes the image: report C's debug pixel, and report B's L = E + KE + K²E + ...
//!
//! Levels are family-wise 1e-3 (Sidak) within each test, two-sided.

use crate::program::{finish, in_memory, pathmark};
use crate::scene_text::{Ball, load_scene};
use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::film::{Bounds, Piece, TileBuffer};
use pathmark::kernel::{self, Event, LightByBounce, PathLog, Spec};
use pathmark::measure::{Settings, Setup};
use pathmark::scene::{Scene, load};
use serde_json::Value;
use std::fs;
use std::sync::Arc;

fn spec(estimator: &str, (width, height): (u32, u32), seed: u64) -> Spec {
    Spec { width, height, seed, estimator: estimator.into(), ..Spec::default() }
}

/// The bits of the radiance that the kernel for the scene gives one sample of a pixel.
fn given(scene: &Arc<Scene>, spec: &Spec, (x, y): (u32, u32), sample: u32) -> [u64; 3] {
    let bounds = Bounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let mut buffer = TileBuffer::new(bounds);
    let piece = Piece { bounds, samples: sample..sample + 1 };
    kernel::build(scene, spec).unwrap().render(&piece, &mut buffer);
    buffer.row_mut(y)[0].sum.map(f64::to_bits)
}

/// One scene of each kind: split paths, chaotic mirrors, glass around the camera, fog, a lens, a hierarchy; samples of
/// all subpixels.
#[test]
fn a_sample_looked_into_is_the_image_s_own() {
    let (width, height) = (48, 36);
    for name in ["cornell", "wada", "overlap", "cornell-fog", "cornell-lens", "spheres:200"] {
        let scene = Arc::new(load(name).unwrap());
        let (mut lit, mut vertices, mut scattered) = (0, 0, 0);
        for estimator in ["smallpt", "bsdf"] {
            let spec = spec(estimator, (width, height), 5);
            let inspector = kernel::inspect(&scene, &spec).unwrap();
            for (index, pixel) in (0..).zip([(0, 0), (47, 35), (13, 28), (30, 26), (24, 5), (35, 27)]) {
                for sample in [index, index + 5, 5 * index + 3, 17, 30, 31, 64, 70_001] {
                    let mut log = PathLog::default();
                    let radiance = inspector.estimate(pixel.0, pixel.1, sample, &mut log);
                    let bits = radiance.channels().map(f64::to_bits);
                    let place = format!("{name}, {estimator}, {pixel:?}, sample {sample}");
                    assert_eq!(bits, given(&scene, &spec, pixel, sample), "{place}");
                    // The light entries add up to the radiance, bit for bit, in the order of the log.
                    assert_eq!(log.light().channels().map(f64::to_bits), bits, "{place}");
                    lit += u32::from(!radiance.is_black());
                    let count = |is: fn(&Event) -> bool| log.events.iter().filter(|event| is(event)).count();
                    vertices += count(|event| matches!(event, Event::Surface { .. }));
                    scattered += count(|event| matches!(event, Event::Fog { .. }));
                    let splits = count(|event| matches!(event, Event::Split { .. }));
                    assert_eq!(count(|event| matches!(event, Event::Ended { .. })), splits + 1, "{place}");
                }
            }
        }
        assert!(lit > 3 && vertices > 40, "{name}: {lit} samples with light and {vertices} vertices show nothing");
        assert_eq!(scattered > 0, name == "cornell-fog", "{name}: {scattered} scatterings in fog");
    }
}

/// The effect profile and the accelerator of an image change no sample; a depth limit cuts image and inspection alike.
#[test]
fn profile_and_hierarchy_do_not_matter() {
    let scene = Arc::new(load("cornell").unwrap());
    let own = |name: &str| Some(name.to_string());
    let mut found = Vec::new();
    for (effects, accelerator, max_depth) in
        [(None, None, None), (own("all"), own("none"), None), (own("all"), own("sah"), None), (None, None, Some(0))]
    {
        let spec = Spec { effects, accelerator, max_depth, ..spec("smallpt", (32, 24), 2) };
        let inspector = kernel::inspect(&scene, &spec).unwrap();
        let samples = (0..32).map(|sample| {
            let radiance = inspector.estimate(16, 19, sample, &mut PathLog::default());
            let bits = radiance.channels().map(f64::to_bits);
            assert_eq!(bits, given(&scene, &spec, (16, 19), sample), "{spec:?}, sample {sample}");
            bits
        });
        found.push(samples.collect::<Vec<_>>());
    }
    assert!(found[0] == found[1] && found[0] == found[2] && found[0] != found[3], "{found:?}");
}

/// The log has the events of a path in order, and each intersection point lies on its ray.
#[test]
fn a_path_is_told_in_order() {
    let scene = Arc::new(load("cornell").unwrap());
    let inspector = kernel::inspect(&scene, &spec("bsdf", (64, 48), 3)).unwrap();
    let mut longest = 0;
    for sample in 0..64 {
        let mut log = PathLog::default();
        inspector.estimate(40, 38, sample, &mut log);
        let mut last = None;
        for event in &log.events {
            if let Event::Surface { bounces, origin, hit, .. } = event {
                assert_eq!(u64::from(*bounces), last.map_or(0, |(bounces, _)| bounces + 1));
                if let Some((_, point)) = last {
                    assert_eq!(*origin, point);
                }
                let way = hit.point - *origin;
                let length = (way.x * way.x + way.y * way.y + way.z * way.z).sqrt();
                assert!((length / hit.t - 1.0).abs() < 1e-9, "{length} for {}", hit.t);
                last = Some((u64::from(*bounces), hit.point));
                longest = longest.max(*bounces);
            }
        }
        assert!(matches!(log.events.last(), Some(Event::Ended { .. })));
    }
    assert!(longest > 5, "no path was long");
}

/// A sampler whose random numbers have no addresses cannot repeat a sample.
#[test]
fn a_sampler_that_forgets_is_refused() {
    let scene = Arc::new(load("cornell").unwrap());
    let spec = Spec { sampler: "per-thread".into(), ..spec("bsdf", (8, 8), 1) };
    let error = kernel::inspect(&scene, &spec).err().unwrap();
    assert!(error.to_string().contains("sampler = per-thread"), "{error}");
}

fn by_bounce(scene: &Arc<Scene>, spec: &Spec, spp: u32) -> LightByBounce {
    LightByBounce::of(&kernel::inspect(scene, spec).unwrap(), spec.width, 0..spec.height, &(0..spp))
}

/// The mean radiance of an image.
fn mean(scene: &Arc<Scene>, spec: &Spec, spp: u32) -> [f64; 3] {
    let settings = Settings { spp, spec: spec.clone(), threads: 1, ..Settings::default() };
    let film = Setup::for_scene(Arc::clone(scene), settings).unwrap().run(None).unwrap().film;
    let sum = |channel: usize| film.pixels().iter().map(|pixel| pixel.mean()[channel]).sum::<f64>();
    std::array::from_fn(|channel| sum(channel) / film.pixels().len() as f64)
}

fn assert_close(found: [f64; 3], expected: [f64; 3], what: &str) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{what}: {found} instead of {expected}");
    }
}

/// All rows sum to the image, and the first rows to the image whose paths are cut at that depth.
#[test]
fn light_by_bounces_is_the_image_taken_apart() {
    for (name, estimator) in
        [("cornell", "smallpt"), ("cornell-fog", "bsdf"), ("wada2", "bsdf"), ("spheres:50", "bsdf")]
    {
        let scene = Arc::new(load(name).unwrap());
        let spec = spec(estimator, (40, 30), 9);
        let found = by_bounce(&scene, &spec, 8);
        assert_eq!((found.samples, found.invalid), (40 * 30 * 8, 0), "{name}");
        let up_to = |depth: usize| {
            let rows = (0..=depth).map(|bounces| found.mean(bounces));
            rows.fold([0.0; 3], |sum, row| std::array::from_fn(|channel| sum[channel] + row[channel]))
        };
        assert_close(up_to(found.rows.len()), mean(&scene, &spec, 8), name);
        for depth in [0, 1, 2, 3, 5, 7, 12] {
            let cut = Spec { max_depth: Some(depth), ..spec.clone() };
            assert_close(up_to(usize::from(depth)), mean(&scene, &cut, 8), &format!("{name} to depth {depth}"));
        }
        let splits = found.parts() - found.samples;
        assert_eq!(splits > 0, name == "cornell", "{name}: {splits} splits");
    }
}

/// In a closed sphere with emission 1 and albedo rho, exactly rho^k arrives over k bounces. Up to the fifth bounce
/// there is no Russian roulette, so each sample has this value. After it, a path survives k - 5 rounds of roulette with
/// probability rho^(k - 5), and the number of survivors is binomial.
#[test]
fn a_closed_sphere_gives_each_bounce_its_power() {
    const ALBEDO: f64 = 0.75;
    let ball = Ball {
        center: [0.0; 3],
        radius: 2.0,
        material: format!("{{ diffuse = {{ albedo = [{ALBEDO}, {ALBEDO}, {ALBEDO}] }} }}"),
        emission: [1.0; 3],
    };
    let scene = Arc::new(load_scene([0.3, -0.2, 0.5], &[ball]).unwrap());
    let found = by_bounce(&scene, &spec("bsdf", (64, 64), 11), 16);
    let n = found.samples as f64;
    let power = |k: usize| (0..k).fold(1.0, |power, _| power * ALBEDO);
    for bounces in 0..=5 {
        let ratio = found.mean(bounces)[0] / power(bounces);
        assert!((ratio - 1.0).abs() < 1e-12, "{bounces} bounces: {ratio}");
        assert_eq!(found.rows[bounces].ended, if bounces == 5 { found.rows[5].ended } else { 0 });
    }
    let limit = critical_value(sidak(1e-3, 20).unwrap()).unwrap();
    for bounces in 6..26 {
        let alive = power(bounces - 5);
        let z = (found.mean(bounces)[1] / power(5) - alive) / (alive * (1.0 - alive) / n).sqrt();
        assert!(z.abs() < limit, "{bounces} bounces: z = {z:.2}");
    }
    // 5 bounces, then as many as roulette allows: geometric, with mean rho / (1 - rho) and variance rho / (1 - rho)^2.
    let (length, expected) = (found.mean_length().unwrap(), 5.0 + ALBEDO / (1.0 - ALBEDO));
    let z = (length - expected) / (ALBEDO / ((1.0 - ALBEDO) * (1.0 - ALBEDO)) / n).sqrt();
    assert!(z.abs() < critical_value(1e-3).unwrap(), "mean length {length} instead of {expected}");
}

fn run(arguments: &[&str], code: i32) -> (String, String) {
    let folder = in_memory();
    let finished = finish(pathmark(folder.path(), arguments)).with_code(code);
    (finished.out, finished.err)
}

fn numbers(value: &Value) -> Vec<u64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap().to_bits()).collect()
}

#[test]
fn a_path_is_printed() {
    let path = ["inspect", "path", "cornell", "--size", "64x48", "--pixel", "40,38", "--sample", "2", "--seed", "4"];
    let json: Value = serde_json::from_str(&run(&[&path[..], &["--json"]].concat(), 0).0).unwrap();
    let scene = Arc::new(load("cornell").unwrap());
    let spec = spec("smallpt", (64, 48), 4);
    assert_eq!(numbers(&json["radiance"]), given(&scene, &spec, (40, 38), 2));
    let events = json["events"].as_array().unwrap();
    let first = events.iter().find(|event| event["event"] == "surface").unwrap();
    assert_eq!((&first["bounces"], &first["side"]), (&Value::from(0), &Value::from("outside")));
    let text = run(&path, 0).0;
    let object = first["object"].as_str().unwrap();
    assert!(
        text.lines().any(|line| line.trim_start().starts_with(&format!("0  {object}, primitive"))
            || line.starts_with(&format!("0        {object}, primitive"))),
        "{text}"
    );
    let printed = text.lines().find_map(|line| line.strip_prefix("radiance ")).unwrap();
    let printed: Vec<u64> = printed.split(' ').map(|number| number.parse::<f64>().unwrap().to_bits()).collect();
    assert_eq!(printed, numbers(&json["radiance"]));
}

#[test]
fn bounces_are_printed_and_written() {
    let folder = in_memory();
    let arguments = ["inspect", "bounces", "cornell", "--size", "32x24", "--spp", "4", "--csv", "rows.csv"];
    let text = finish(pathmark(folder.path(), &arguments)).with_code(0).out;
    assert!(text.contains("end before 6 bounces"), "{text}");
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).unwrap();
    let json: Value = serde_json::from_str(&run(&[&arguments[..7], &["--json"]].concat(), 0).0).unwrap();
    assert_eq!(rows.lines().count() - 1, json["bounces"].as_array().unwrap().len());
    let scene = Arc::new(load("cornell").unwrap());
    let expected = mean(&scene, &spec("smallpt", (32, 24), 1), 4);
    assert_close(std::array::from_fn(|channel| json["mean"][channel].as_f64().unwrap()), expected, "mean");
    let last = rows.lines().last().unwrap().split(',').collect::<Vec<_>>();
    assert!(
        (last[5].parse::<f64>().unwrap() - 1.0).abs() < 1e-12 && (last[8].parse::<f64>().unwrap() - 1.0).abs() < 1e-12
    );
}

#[test]
fn traces_that_cannot_be_replayed_are_refused() {
    for (arguments, field) in [
        (["--pixel", "64,0", "--size", "64x48"], "pixel = 64,0"),
        (["--pixel", "0,48", "--size", "64x48"], "pixel = 0,48"),
        (["--pixel", "-1,0", "--size", "64x48"], "pixel = -1,0"),
        (["--pixel", "middle", "--size", "64x48"], "pixel = middle"),
        (["--pixel", "0,0", "--size", "0x48"], "size = 0x48"),
        (["--pixel", "0,0", "--sample", "16777216"], "sample = 16777216"),
        (["--pixel", "0,0", "--sampler", "libc-rand"], "sampler = libc-rand"),
        (["--pixel", "0,0", "--estimator", "guess"], "estimator = guess"),
        (["--pixel", "0,0", "--seed", "9223372036854775808"], "seed = 9223372036854775808"),
    ] {
        let error = run(&[&["inspect", "path", "cornell"][..], &arguments].concat(), 2).1;
        assert!(error.contains(field), "{field}: {error}");
    }
    let error = run(&["inspect", "path", "nowhere", "--pixel", "0,0"], 2).1;
    assert!(error.contains("scene = nowhere"), "{error}");
    let error = run(&["inspect", "bounces", "cornell", "--spp", "3"], 2).1;
    assert!(error.contains("spp = 3"), "{error}");
}

/// Every kernel finds the intersections that the paths found. The exported file has the triangles and the rays, all
/// finite.
#[test]
fn rays_are_searched_alone_and_exported() {
    let folder = in_memory();
    let size = ["--size", "24x16", "--estimator", "bsdf", "--spp", "2", "--repetitions", "2", "--json"];
    let json = |more: &[&str]| -> Value {
        let arguments = [&["inspect", "rays", "bumpy-ball:500"][..], &size, more].concat();
        serde_json::from_str(&finish(pathmark(folder.path(), &arguments)).with_code(0).out).unwrap()
    };
    let scalar = json(&["--kernel", "scalar", "--export", "rays"]);
    let rays = scalar["rays"].as_u64().unwrap();
    assert!(rays > 1000 && scalar["met"] == scalar["rays"], "{scalar}");
    for accelerator in ["none", "median", "sah"] {
        let lanes = json(&["--kernel", "lanes", "--accelerator", accelerator]);
        assert_eq!((&lanes["met"], &lanes["distance"]), (&scalar["met"], &scalar["distance"]), "{accelerator}");
        assert_eq!(lanes["rays_per_s"].as_array().unwrap().len(), 2);
    }
    let file = fs::read(folder.path().join("rays")).unwrap();
    let triangles = scalar["primitives"].as_u64().unwrap();
    let head = format!("pathmark-rays 1 {triangles} {rays}\n");
    let numbers = file.strip_prefix(head.as_bytes()).unwrap();
    assert_eq!(numbers.len() as u64, 8 * (9 * triangles + 7 * rays));
    let numbers = numbers.as_chunks::<8>().0.iter().map(|number| f64::from_le_bytes(*number));
    assert!(numbers.into_iter().all(f64::is_finite));

    let refused = |arguments: &[&str], told: &str| {
        let error = finish(pathmark(folder.path(), &[&["inspect", "rays"][..], arguments].concat())).with_code(2).err;
        assert!(error.contains(told), "{error}");
    };
    refused(&["cornell", "--estimator", "bsdf", "--export", "spheres"], "spheres or planes");
    refused(&["cornell", "--estimator", "smallpt"], "estimator = smallpt");
    refused(&["cornell-fog", "--estimator", "bsdf"], "fog");
    refused(&["mandelbrot"], "workload");
    assert!(!folder.path().join("spheres").exists());
}

/// A lamp too bright for f32 makes samples invalid there. With each of these render options, the printed replay command
/// shows such a sample again.
#[test]
fn a_told_command_shows_the_invalid_sample_on_every_axis() {
    let folder = in_memory();
    let scene = "about = 'a test'\nbase = 'cornell'\n[[objects]]\nname = 'light'\nemission = [1e39, 1e39, 1e39]\n";
    std::fs::write(folder.path().join("bright.toml"), scene).unwrap();
    let axes: [&[&str]; 8] = [
        &[],
        &["--size", "20x31"],
        &["--seed", "77"],
        &["--estimator", "mis"],
        &["--sampler", "sobol"],
        &["--max-depth", "2"],
        &["--roulette", "throughput:3"],
        &["--estimator", "bsdf", "--roulette", "never", "--max-depth", "40"],
    ];
    for axis in axes {
        let base = ["render", "bright.toml", "--spp", "16", "--precision", "f32", "-o", "image.pfm"];
        let size = if axis.contains(&"--size") { vec![] } else { vec!["--size", "32x24"] };
        let render = finish(pathmark(folder.path(), &[&base[..], &size, axis].concat())).with_code(0);
        let told: Vec<&str> =
            render.err.lines().filter_map(|line| line.strip_prefix("pathmark inspect path ")).collect();
        assert!((1..=10).contains(&told.len()), "{axis:?}: {}", render.err);
        for command in told {
            let arguments: Vec<&str> = ["inspect", "path"].into_iter().chain(command.split(' ')).collect();
            let replay = finish(pathmark(folder.path(), &arguments)).with_code(0);
            assert!(replay.out.contains("This radiance is invalid"), "{command}: {}", replay.out);
            let json = finish(pathmark(folder.path(), &[&arguments[..], &["--json"]].concat())).with_code(0).out;
            let json: Value = serde_json::from_str(&json).unwrap();
            assert_eq!((&json["valid"], &json["precision"]), (&false.into(), &"f32".into()), "{command}");
        }
    }
}

/// In f32, a replay shows the radiance that the image gets, but not the path; light by bounces is refused.
#[test]
fn single_precision_is_looked_into_as_far_as_it_can_be() {
    let base =
        ["inspect", "path", "cornell", "--size", "64x48", "--pixel", "40,38", "--seed", "4", "--precision", "f32"];
    let scene = Arc::new(load("cornell").unwrap());
    let single = Spec { precision: "f32".into(), ..spec("smallpt", (64, 48), 4) };
    let double = spec("smallpt", (64, 48), 4);
    let mut others = 0;
    for sample in 0..8 {
        let text = sample.to_string();
        let arguments = [&base[..], &["--sample", &text, "--json"]].concat();
        let json: Value = serde_json::from_str(&run(&arguments, 0).0).unwrap();
        let expected = given(&scene, &single, (40, 38), sample);
        assert_eq!(numbers(&json["radiance"]), expected);
        assert!(json["events"].is_null() && json["valid"] == true, "{json}");
        others += u32::from(expected != given(&scene, &double, (40, 38), sample));
        assert!(run(&arguments[..arguments.len() - 1], 0).0.contains("SIMD lanes"));
    }
    assert!(others > 0, "f64 gives the same samples");
    let refused = run(&["inspect", "bounces", "cornell", "--size", "8x6", "--precision", "f32"], 2).1;
    assert!(refused.contains("precision = f32") && refused.contains("allowed: f64"), "{refused}");
    // Scenes that lanes do not support are rendered in f64, whatever precision was requested.
    let fog = ["inspect", "bounces", "cornell-fog", "--size", "8x6", "--precision", "f32", "--json"];
    let same = ["inspect", "bounces", "cornell-fog", "--size", "8x6", "--json"];
    assert_eq!(run(&fog, 0).0, run(&same, 0).0);
}

/// Equal images have an infinite PSNR. JSON has no number for it, and it must differ from an absent value.
#[test]
fn infinity_is_told_from_nothing_in_json() {
    let folder = in_memory();
    let render = ["render", "cornell", "--size", "32x24", "--spp", "4", "-o", "a.pfm", "--json"];
    let record: Value = serde_json::from_str(&finish(pathmark(folder.path(), &render)).with_code(0).out).unwrap();
    assert!(record["rmse"].is_null() && record["mean_radiance"].is_number(), "{record}");
    let compared = finish(pathmark(folder.path(), &["image", "compare", "a.pfm", "a.pfm", "--json"])).with_code(0).out;
    let compared: Value = serde_json::from_str(&compared).unwrap();
    assert_eq!((&compared["psnr"], &compared["mse"]), (&"inf".into(), &0.0.into()), "{compared}");
}

/// A trace keeps the warnings about its run's times, for a reader on another day.
#[test]
fn a_trace_tells_doubts_about_its_times() {
    let folder = in_memory();
    let render = ["render", "cornell", "--size", "24x16", "--spp", "4", "--strategy", "serial", "--trace", "run.csv"];
    finish(pathmark(folder.path(), &render)).with_code(0);
    let path = folder.path().join("run.csv");
    let text = fs::read_to_string(&path).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let with = |warnings: &str| {
        let mut header: Value = serde_json::from_str(header.trim_start_matches('#')).unwrap();
        header["warnings"] = warnings.into();
        fs::write(&path, format!("# {header}\n{rows}")).unwrap();
        finish(pathmark(folder.path(), &["inspect", "jobs", "run.csv"])).with_code(0).err
    };
    assert!(with("biased;foreign-load(20 %)").contains("foreign-load(20 %)"));
    assert_eq!(with("biased"), "");
}
