//! No output may be an input or another output of its command, however the two are spelled: every verb, each of its pairs, each spelling.

use super::program::{finish, pathmark};
use super::refused;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

/// A verb with all its files. All options of the verb accept the names of its inputs.
struct Verb {
    arguments: &'static [&'static str],
    inputs: &'static [&'static str],
    /// Options, and the names of their fields in errors.
    outputs: &'static [(&'static str, &'static str)],
}

const RENDER: &[&str] = &["render", "./scene.ppm", "--size", "8x8", "--spp", "4"];
const SCENE: &[&str] = &["scene.ppm", "base.ppm", "mesh.ppm"];

const VERBS: &[Verb] = &[
    Verb {
        arguments: RENDER,
        inputs: SCENE,
        outputs: &[("-o", "image"), ("--trace", "trace"), ("--checkpoint", "checkpoint")],
    },
    Verb {
        arguments: &["inspect", "bounces", "./scene.ppm", "--size", "8x8"],
        inputs: SCENE,
        outputs: &[("--csv", "csv")],
    },
    Verb { arguments: &["inspect", "jobs", "run.png"], inputs: &["run.png"], outputs: &[("-o", "output")] },
    Verb {
        arguments: &["image", "compare", "image.png", "reference.png"],
        inputs: &["image.png", "reference.png"],
        outputs: &[("--heatmap", "heatmap")],
    },
    Verb { arguments: &["image", "convert", "image.png"], inputs: &["image.png"], outputs: &[("-o", "output")] },
];

const BASE: &str = r#"about = "a base"
background = [1.0, 1.0, 1.0]
[camera.pinhole]
position = [0.0, 0.0, 3.0]
look-at = [0.0, 0.0, 0.0]
field-of-view = 40.0
"#;
const OBJECT: &str = r#"
[[objects]]
name = "mesh"
shape = { mesh = { file = "mesh.ppm" } }
material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }
"#;

/// Writes all inputs of all verbs.
fn inputs(folder: &Path) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("mesh.ppm", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    write("base.ppm", &format!("{BASE}{OBJECT}"));
    write("scene.ppm", "about = \"a scene\"\nbase = \"./base.ppm\"\n");
    let render = |output: &str, seed: &str| {
        let more = ["-o", output, "--trace", "run.png", "--seed", seed];
        finish(pathmark(folder, &[RENDER, &more].concat())).with_code(0);
    };
    render("image.png", "1");
    render("reference.png", "2");
}

/// Other spellings of the file `name`; creates the links that they use.
fn spellings(folder: &Path, name: &str) -> Vec<String> {
    fs::create_dir_all(folder.join("sub")).unwrap();
    let link = |link: String, target: &str| {
        symlink(target, folder.join(&link)).unwrap();
        link
    };
    if !folder.join("upper").exists() {
        link("upper".into(), ".");
    }
    let direct = link(format!("link-{name}"), name);
    let absolute = folder.join(name).to_str().unwrap().to_owned();
    let mut spellings = vec![
        name.to_owned(),
        format!("./{name}"),
        format!("sub/../{name}"),
        format!("upper/{name}"),
        link(format!("links-{name}"), &direct),
        link(format!("sub-{name}"), &format!("sub/../upper/{name}")),
        direct,
        absolute,
    ];
    if folder.join(name).exists() {
        let hard = format!("hard-{name}");
        fs::hard_link(folder.join(name), folder.join(&hard)).unwrap();
        spellings.push(hard);
    }
    spellings
}

#[test]
fn no_output_is_an_input() {
    let folder = tempfile::tempdir().unwrap();
    inputs(folder.path());
    let mut names: Vec<&str> = VERBS.iter().flat_map(|verb| verb.inputs).copied().collect();
    names.sort_unstable();
    names.dedup();
    let spelled: Vec<(&str, Vec<String>)> = names.iter().map(|name| (*name, spellings(folder.path(), name))).collect();
    for Verb { arguments, inputs, outputs } in VERBS {
        for (input, spellings) in spelled.iter().filter(|(name, _)| inputs.contains(name)) {
            for (option, field) in *outputs {
                for spelling in spellings {
                    println!("{} {option} {spelling} for {input}", arguments.join(" "));
                    let said = [&*format!("{field} = {spelling}: is "), "would be overwritten"];
                    refused(folder.path(), &[*arguments, &[*option, spelling]].concat(), 2, &said);
                }
            }
        }
    }
}

#[test]
fn no_two_outputs_are_one_file() {
    let folder = tempfile::tempdir().unwrap();
    inputs(folder.path());
    fs::write(folder.path().join("there.png"), "kept").unwrap();
    let spelled = ["there.png", "new.png"].map(|name| (name, spellings(folder.path(), name)));
    for Verb { arguments, outputs, .. } in VERBS {
        for (index, (first, _)) in outputs.iter().enumerate() {
            for (second, field) in &outputs[index + 1..] {
                for (name, spelling) in spelled.iter().flat_map(|(name, all)| all.iter().map(move |s| (name, s))) {
                    println!("{} {first} {name} {second} {spelling}", arguments.join(" "));
                    let both = [first, name, second, &**spelling];
                    let said = [&*format!("{field} = {spelling}: is also the file of")];
                    refused(folder.path(), &[*arguments, &both].concat(), 2, &said);
                }
            }
        }
    }
}
