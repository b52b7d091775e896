//! Experiments over scenes: all of them with their own estimators, the gallery, the price of an effect, and accuracy by scene.

use super::{json, run};
use crate::experiment::{TINY, write_tiny};
use crate::program::in_memory;
use pathmark::Lab;
use pathmark::effect::Effects;
use pathmark::experiment::{Definition, Profile};
use pathmark::material::MATERIALS;
use pathmark::scene::{FEATURES, PRIMITIVES, PROFILES, SCENES, load};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// `TINY` over other scenes, with one schedule and one figure.
fn tiny(scenes: &str, figure: &str, more: &str) -> String {
    let strategies = ("[\"serial\", \"static-blocks\", \"work-stealing\"]", "[\"serial\"]");
    let text =
        TINY.replace(strategies.0, strategies.1).replace("[1, 2]", "[1]").replace("[\"smallpt\"]", "[\"default\"]");
    let figures = format!("figures = [\"{figure}\"]\n{more}");
    text.replace("figures = [\"speedup\", \"schedules\"]\n", &figures).replace("[\"cornell\"]", scenes)
}

#[test]
fn an_experiment_can_take_all_scenes_with_their_own_estimators() {
    let definition =
        Definition::from_text(&Lab::built_in(), "tiny", "tiny.toml", &tiny("[\"all\"]", "gallery", "")).unwrap();
    let cells = definition.cells(Profile::Quick).unwrap();
    let found: Vec<(&str, &str)> = cells.iter().map(|c| (&*c.settings.scene, &*c.settings.spec.estimator)).collect();
    for ((name, _), (scene, estimator)) in SCENES.iter().zip(&found) {
        let own = load(name).unwrap().estimator().to_string();
        assert_eq!((*scene, *estimator), (*name, &*own));
    }
    assert_eq!(found.len(), SCENES.len());
}

#[test]
fn listed_scenes_name_their_effects() {
    let folder = in_memory();
    let listed = json(&run(folder.path(), &["list", "scenes", "--json"]).out);
    let text = run(folder.path(), &["list", "scenes"]).out;
    for item in listed.as_array().unwrap() {
        let scene = load(item["name"].as_str().unwrap()).unwrap();
        let profile = PROFILES.iter().find(|entry| item["profile"] == entry.name).unwrap();
        assert!(profile.effects.cover(scene.effects()) && scene.effects() != Effects::NONE, "{item}");
        assert_eq!(item["primitives"], scene.owners.len(), "{item}");
        let names: Vec<&str> = item["calls_for"].as_str().unwrap().split('+').collect();
        let named = PRIMITIVES.iter().chain(MATERIALS).chain(FEATURES).filter(|entry| names.contains(&entry.name));
        assert_eq!(named.fold(Effects::NONE, |all, entry| all.and(entry.effect)), scene.effects(), "{item}");
        assert!(text.contains(item["about"].as_str().unwrap()) && text.contains(item["calls_for"].as_str().unwrap()));
    }
    assert!(text.lines().all(|line| line.chars().count() <= 140), "{text}");
}

#[test]
fn a_gallery_shows_each_scene_once() {
    let folder = in_memory();
    let text =
        tiny("[\"cornell\", \"spheres\"]", "gallery", "keep = [\"images\"]\n").replace("spp = [4]", "spp = [4, 8]");
    write_tiny(folder.path(), &text);
    run(folder.path(), &["run", "tiny.toml", "--out", "out", "--repetitions", "1"]);
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("alt=\"2 scenes\""));
    assert!(folder.path().join("out/tiny/figures/gallery.png").is_file());
    // Without the images, the page has a sentence instead.
    fs::remove_dir_all(folder.path().join("out/tiny/images")).unwrap();
    run(folder.path(), &["report", "out"]);
    assert!(fs::read_to_string(folder.path().join("out/report.html")).unwrap().contains("There is no gallery"));
}

/// Runs an experiment, changes its rows, redraws its report, and reads one of its tables: rows by their first cell.
fn with_rows(
    folder: &Path,
    text: &str,
    change: impl Fn(&mut BTreeMap<String, String>),
    table: &str,
) -> BTreeMap<String, Vec<String>> {
    write_tiny(folder, text);
    run(folder, &["run", "tiny.toml", "--out", "out"]);
    let path = folder.join("out/tiny/records.csv");
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let heads = reader.headers().unwrap().clone();
    let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(Result::unwrap).collect();
    let mut writer = csv::Writer::from_path(&path).unwrap();
    writer.write_record(&heads).unwrap();
    for mut row in rows {
        change(&mut row);
        writer.write_record(heads.iter().map(|head| &row[head])).unwrap();
    }
    writer.flush().unwrap();
    run(folder, &["report", "out"]);
    let mut reader = csv::Reader::from_path(folder.join("out/tiny/figures").join(table)).unwrap();
    let cells = |row: csv::StringRecord| row.iter().map(str::to_string).collect::<Vec<_>>();
    reader.records().map(|row| cells(row.unwrap())).map(|row| (row[0].clone(), row)).collect()
}

/// The comparison of one effect for the figure `effects`.
const GLASS: &str = r#"
[[figure.effects.price]]
effect = "mirror and glass"
absent = { scene = "cornell-diffuse", profile = "diffuse" }
unused = { scene = "cornell-diffuse", profile = "smallpt" }
used = { scene = "cornell", profile = "smallpt" }
"#;

/// The fitting profile and the profile's own name are one run, and a short curve is the beginning of a long one.
#[test]
fn two_words_for_one_run_are_one_cell() {
    let ids = |text: &str| {
        let definition = Definition::from_text(&Lab::built_in(), "tiny", "tiny.toml", text).unwrap();
        let cells = definition.cells(Profile::Quick).unwrap();
        cells.iter().flat_map(|cell| &cell.points).map(|point| point.id.clone()).collect::<Vec<String>>()
    };
    let scalar = tiny("[\"cornell\"]", "effects", "").replace("spp = [4]", "spp = [4]\nkernel = [\"scalar\"]");
    let once = ids(&scalar);
    assert_eq!(once, ids(&scalar.replace("spp = [4]", "spp = [4]\neffects = [\"fitting\", \"smallpt\"]")));
    let curves =
        |spp: &str| tiny("[\"cornell\"]", "effects", "").replace("spp = [4]", &format!("spp = {spp}\ncurve = true"));
    assert_eq!((ids(&curves("[16]")).len(), ids(&curves("[8, 16]")).len(), ids(&curves("[16, 8]")).len()), (3, 3, 3));
}

/// The test writes times into the rows, so the ratios are known.
#[test]
fn the_price_of_an_effect_is_a_ratio_of_times() {
    let folder = in_memory();
    let text = tiny("[\"cornell\", \"cornell-diffuse\"]", "effects", GLASS)
        .replace("spp = [4]", "spp = [4]\nkernel = [\"scalar\"]\neffects = [\"fitting\", \"smallpt\", \"all\"]");
    // A sample takes 1000 ns with the fitting profile, 1100 with the next and 1250 with the largest. Each repetition is
    // slower by a common factor.
    let change = |row: &mut BTreeMap<String, String>| {
        let ns = match (row["scene"].as_str(), row["effects"].as_str()) {
            (_, "all") => 1250.0,
            ("cornell-diffuse", "smallpt") => 1100.0,
            _ => 1000.0,
        };
        let (paths, repetition): (f64, f64) = (row["samples"].parse().unwrap(), row["repetition"].parse().unwrap());
        row.insert("cpu_user_s".into(), (ns * 1e-9 * paths * (1.0 + repetition)).to_string());
        row.insert("cpu_system_s".into(), "0".into());
    };
    let profiles = with_rows(folder.path(), &text, change, "profiles-table.csv");
    for scene in ["cornell", "cornell-diffuse"] {
        let row = &profiles[scene];
        // The times with the fitting and the largest profile, and the ratio with its interval.
        for (text, expected) in row[2..7].iter().zip([2000.0, 2500.0, 1.25, 1.25, 1.25]) {
            assert!((text.parse::<f64>().unwrap() / expected - 1.0).abs() < 1e-12, "{row:?}");
        }
    }
    assert_eq!((profiles["cornell"][1].as_str(), profiles["cornell-diffuse"][1].as_str()), ("smallpt", "diffuse"));
    let effects = csv::Reader::from_path(folder.path().join("out/tiny/figures/effects-table.csv")).unwrap();
    let rows: Vec<BTreeMap<String, String>> = effects.into_deserialize().collect::<csv::Result<_>>().unwrap();
    let glass = rows.iter().find(|row| row["effect"] == "mirror and glass").unwrap();
    for (head, expected) in [("ratio unused / absent", 1.1), ("ratio used / absent", 1.0)] {
        for end in ["", ": low", ": high"] {
            let value: f64 = glass[&format!("{head}{end}")].parse().unwrap();
            assert!((value - expected).abs() < 1e-12, "{head}{end}: {glass:?}");
        }
    }
}

/// The test writes errors into the rows: relative errors are divided by the mean radiance of the kept images, and the
/// most accurate scene comes first.
#[test]
fn accuracy_by_scene_is_relative_to_its_brightness() {
    let folder = in_memory();
    let scenes = "[\"cornell\", \"cornell-diffuse\", \"cornell-mirror\", \"forest\", \"wada\"]";
    let more = "keep = [\"images\"]\n[figure.scene-accuracy.control]\ndiffuse = \"cornell-diffuse\"\nglass = \"cornell\"\nmirrors = \"cornell-mirror\"\n";
    let text = tiny(scenes, "scene-accuracy", more).replace("seed = [1]", "seed = [1, 2, 3]");
    let rmse = |scene: &str, seed: f64| match scene {
        "cornell" => 0.2 * seed,
        // Half the box's error, times factors whose logarithms sum to zero.
        "cornell-diffuse" => 0.1 * seed * [1.1, 1.0, 1.0 / 1.1][seed as usize - 1],
        "cornell-mirror" => 0.4 * (4.0 - seed),
        _ => 0.3 * seed,
    };
    let change = |row: &mut BTreeMap<String, String>| {
        let rmse = rmse(&row["scene"], row["seed"].parse().unwrap());
        row.insert("mse".into(), (rmse * rmse).to_string());
    };
    let table = with_rows(folder.path(), &text, change, "scene-accuracy-table.csv");
    for (scene, row) in &table {
        let number = |column: usize| row[column].parse::<f64>().unwrap();
        let squares = [1.0, 2.0, 3.0].map(|seed| rmse(scene, seed) * rmse(scene, seed));
        let expected = (squares.iter().sum::<f64>() / 3.0).sqrt();
        assert!((number(2) - expected).abs() < 1e-4, "{row:?}");
        assert!((number(3) - number(2) / number(1)).abs() < 1e-3, "{row:?}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    // In the geometric mean, twice the error of the diffuse box; the images' brightness differs a little.
    let radiance = |scene: &str| table[scene][1].parse::<f64>().unwrap();
    let ratio = 2.0 * radiance("cornell-diffuse") / radiance("cornell");
    let said = page.split("its relative error is ").nth(1).unwrap().split(' ').next().unwrap().parse::<f64>().unwrap();
    assert!((said - ratio).abs() < 0.01, "{said} instead of {ratio}");
    assert!(page.contains("Over 3 different scenes"));
}

/// A mesh with unused parts: reported once, however many objects use the file.
#[test]
fn unused_parts_of_a_mesh_are_told_once() {
    let folder = in_memory();
    let mesh = "mtllib a.mtl\nv 0 0 0\nv 9 0 0\nv 0 9 0\nvn 0 0 1\nvt 0 0\no one\nusemtl red\nf 1/1/1 2/1/1 3/1/1\no two\nf 1 2 3\n";
    fs::write(folder.path().join("a.obj"), mesh).unwrap();
    let object = |name: &str| {
        format!(
            "[[objects]]\nname = \"{name}\"\nshape = {{ mesh = {{ file = \"a.obj\", object = \"{name}\" }} }}\nmaterial = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}\n"
        )
    };
    let scene = format!("about = \"Two\"\nbase = \"cornell\"\n{}{}", object("one"), object("two"));
    fs::write(folder.path().join("two.toml"), scene).unwrap();
    let told = run(folder.path(), &["render", "two.toml", "--size", "8x8", "--spp", "4"]).err;
    assert_eq!(told.matches("a.obj: materials, normals, texture coordinates are not used").count(), 1, "{told}");
}
