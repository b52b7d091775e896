//! Scenes with a base, and generators: wrong inheritance, omissions and counts.

use super::{line_of, place, refused};
use crate::program::in_memory;
use std::fs;
use std::path::Path;

const CAMERA: &str = "[camera.pinhole]\nposition = [0.0, 0.0, 5.0]\nlook-at = [0.0, 0.0, 0.0]\nfield-of-view = 40.0\n";
const BALL: &str = "[[objects]]\nname = \"ball\"\nshape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }\n\
                    material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\n";

/// Writes the files and renders `scene.toml`; returns the message of the refusal.
fn refused_scene(files: &[(&str, &str)], said: &[&str]) -> String {
    let folder = in_memory();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    refused(folder.path(), &["render", "scene.toml", "--size", "8x8", "--spp", "4", "-o", "image.png"], 2, said)
}

fn line(message: &str, file: &str) -> Option<usize> {
    place(message, file).map(|at| at.0)
}

#[test]
fn bases_that_are_not_there_are_refused() {
    let with = |base: &str| format!("about = 'x'\nbase = '{base}'\n");
    for (base, said) in [
        ("nowhere", &["base = nowhere", "cornell", "path of a .toml file"][..]),
        ("nowhere.toml", &["base = nowhere.toml", "no such file"]),
        ("/dev/zero", &["base = /dev/zero", "byte 0 is zero"]),
        (".", &["base = ."]),
        ("spheres:5", &["base = spheres:5", "has a number", "spheres; a table [generator.NAME]"]),
    ] {
        if base.starts_with('/') && !Path::new(base).exists() {
            continue;
        }
        let message = refused_scene(&[("scene.toml", &with(base))], said);
        assert_eq!(line(&message, "scene.toml"), Some(2), "{message}");
    }
    // A mistake in a base is reported in the base's file.
    let wrong = format!("about = 'x'\n{CAMERA}{BALL}").replace("radius = 1.0", "radius = 0.0");
    let message = refused_scene(&[("scene.toml", &with("other.toml")), ("other.toml", &wrong)], &["radius", "1e-100"]);
    assert_eq!(line(&message, "other.toml"), Some(line_of(&wrong, "radius")), "{message}");
    refused_scene(&[("scene.toml", "about = 'x'\nbase = 7\n")], &["base", "7", "string"]);
}

#[test]
fn circles_and_long_chains_of_bases_are_refused() {
    let with = |base: &str| format!("about = 'x'\nbase = '{base}'\n");
    let message = refused_scene(&[("scene.toml", &with("scene.toml"))], &["base = scene.toml", "circle"]);
    assert_eq!(line(&message, "scene.toml"), Some(2), "{message}");
    let circle = [("scene.toml", with("a.toml")), ("a.toml", with("b.toml")), ("b.toml", with("scene.toml"))];
    let circle = circle.each_ref().map(|(name, text)| (*name, text.as_str()));
    let message = refused_scene(&circle, &["base", "circle"]);
    assert!(line(&message, ".toml") == Some(2), "{message}");

    let chain: Vec<(String, String)> = (0..10_000)
        .map(|k| {
            (if k == 0 { "scene.toml".to_string() } else { format!("{k}.toml") }, with(&format!("{}.toml", k + 1)))
        })
        .collect();
    let chain: Vec<(&str, &str)> = chain.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    refused_scene(&chain, &["base"]);
}

#[test]
fn objects_that_do_not_fit_the_base_are_refused() {
    let scene = |rest: &str| format!("about = 'x'\nbase = 'cornell'\n{rest}");
    for (rest, said) in [
        ("without = ['chandelier']\n", &["without = chandelier", "no object of that name"][..]),
        ("without = ['light', 'light']\n", &["without = light", "no object of that name"]),
        ("without = 'light'\n", &["without", "sequence"]),
        (
            "[[objects]]\nname = 'new'\nmaterial = { mirror = { albedo = [1.0, 1.0, 1.0] } }\n",
            &["name = new", "no shape"],
        ),
        (
            "[[objects]]\nname = 'new'\nshape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }\n",
            &["name = new", "no material"],
        ),
        ("[[objects]]\nemission = [1.0, 1.0, 1.0]\n", &["name", "missing"]),
    ] {
        let text = scene(rest);
        let message = refused_scene(&[("scene.toml", &text)], said);
        assert!(line(&message, "scene.toml").is_some_and(|line| line >= 3), "{message}");
    }
    let twice = format!("about = 'x'\n{CAMERA}{BALL}{BALL}");
    refused_scene(&[("scene.toml", &twice)], &["name = ball", "two objects"]);
    let all = "left wall, right wall, back wall, front wall, floor, ceiling, mirror ball, glass ball, light";
    let nothing = scene(&format!("without = {:?}\n", all.split(", ").collect::<Vec<_>>()));
    refused_scene(&[("scene.toml", &nothing)], &["objects", "at least one"]);
}

#[test]
fn numbers_of_generators_are_checked() {
    let folder = in_memory();
    for (scene, allowed) in [
        ("spheres:0", "1 to 10000000"),
        ("spheres:-1", "1 to 10000000"),
        ("spheres:1.5", "1 to 10000000"),
        ("spheres:1e99", "1 to 10000000"),
        ("spheres:nan", "1 to 10000000"),
        ("furnace:1", "below 1"),
        ("furnace:-0.1", "from 0"),
        ("imbalance:6", "from 7 to 1000"),
        ("imbalance:inf", "from 7 to 1000"),
        ("cornell:5", "only scenes with a generator"),
        ("spheres:many", "spheres"),
    ] {
        refused(folder.path(), &["render", scene, "-o", "image.png"], 2, &[scene, allowed]);
    }
    for (generator, said) in [
        ("[generator.spheres]\ncount = 0\nseed = 1\n", &["count = 0", "1 to 10000000"][..]),
        ("[generator.spheres]\ncount = 4000000000\nseed = 1\n", &["count = 4000000000", "1 to 10000000"]),
        ("[generator.spheres]\ncount = 5000000000\nseed = 1\n", &["count", "5000000000", "u32"]),
        ("[generator.spheres]\ncount = 10\nseed = -1\n", &["seed", "-1", "u64"]),
        ("[generator.furnace]\nalbedo = nan\n", &["albedo = NaN", "below 1"]),
        ("[generator.imbalance]\nfactor = 1e400\n", &["factor"]),
        ("[generator.fractal]\ndepth = 3\n", &["fractal", "spheres", "furnace"]),
    ] {
        let text = format!("about = 'x'\n{CAMERA}{generator}");
        let message = refused_scene(&[("scene.toml", &text)], said);
        assert!(line(&message, "scene.toml").is_some_and(|line| line >= 6), "{message}");
    }
}

/// Twenty thousand objects, the last of which is wrong; and a hundred thousand, which would take a gigabyte to parse.
#[test]
fn very_many_objects_are_read_or_refused() {
    let with = |count: usize| {
        let mut text = format!("about = 'x'\n{CAMERA}");
        for k in 1..=count {
            let radius = if k == count { -1.0 } else { 1.0 };
            let shape = format!("{{ sphere = {{ center = [{k}.0, 0.0, 0.0], radius = {radius:?} }} }}");
            let material = "{ diffuse = { albedo = [0.5, 0.5, 0.5] } }";
            text.extend(["[[objects]]\n", &format!("name = '{k}'\nshape = {shape}\nmaterial = {material}\n")]);
        }
        text
    };
    let text = with(20_000);
    let message = refused_scene(&[("scene.toml", &text)], &["radius = -1.0", "1e-100 to 1e100"]);
    assert_eq!(line(&message, "scene.toml"), Some(line_of(&text, "radius = -1.0")), "{message}");
    refused_scene(&[("scene.toml", &with(100_000))], &["scene.toml", "3 MiB"]);
}
