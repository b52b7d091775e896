//! Inputs edited while a sweep runs: a scene, its base, its mesh, references, the experiment itself. Rows of two
//! versions are never mixed: each row is of the inputs that the sweep began with, or reports a failure.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use pathmark::Lab;
use pathmark::experiment::{Definition, Options, Progress, Sweep};
use pathmark::files::Files;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const RUN: [&str; 4] = ["run", "tiny.toml", "--out", "out"];

const BASE: &str = r#"about = "a base"
background = [1.0, 1.0, 1.0]
[camera.pinhole]
position = [0.0, 0.0, 3.0]
look-at = [0.0, 0.0, 0.0]
field-of-view = 40.0
"#;
const MESH: &str = r#"
[[objects]]
name = "mesh"
shape = { mesh = { file = "mesh.obj" } }
material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }
"#;

/// Writes a scene of three files and an experiment with references and another program. That program runs `deed` once,
/// after the references are rendered and before the first row.
fn prepare(folder: &Path, deed: &str) {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write("mesh.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    write("base.toml", &format!("{BASE}{MESH}"));
    write("scene.toml", "about = \"a scene\"\nbase = \"base.toml\"\n");
    let once = format!("test -e done && exit 0; touch done; {deed}");
    let external = format!(
        "[[external]]\nname = \"other\"\nscene = \"cornell\"\nspp = [4]\nseed = [7]\nbuild = [\"sh\", \"-c\", '{once}']\n\
         command = [\"./nowhere\", \"{{out}}\", \"{{spp}}\", \"{{seed}}\"]\n"
    );
    let text = TINY.replace(
        "[quick]\n",
        &format!("{external}\n[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n"),
    );
    let text = text.replace("[\"cornell\"]", "[\"scene.toml\"]").replace("repetitions = 3", "repetitions = 1");
    write_tiny(folder, &text);
}

fn rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(folder.join("out/tiny/records.csv")).unwrap();
    let rows = reader.deserialize().map(|row| row.unwrap());
    rows.filter(|row: &BTreeMap<String, String>| row["estimator"] != "other").collect()
}

#[test]
fn inputs_that_change_under_a_sweep_fail_its_rows() {
    let deeds = [
        ("the scene", "echo >> scene.toml"),
        ("its base", "echo >> base.toml"),
        ("its mesh", "echo >> mesh.obj"),
        ("a scene of another name", "mv scene.toml old.toml; cp base.toml scene.toml"),
        ("a reference", "cd out/references; set -- scene-*half0.film; cp other.film $1"),
        ("the references, by each other", "cd out/references; set -- scene-*half?.film; mv $1 x; mv $2 $1; mv x $2"),
    ];
    for (what, deed) in deeds {
        println!("{what}");
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        prepare(folder, deed);
        let files = ["scene.toml", "base.toml", "mesh.obj"].map(|name| (name, fs::read(folder.join(name)).unwrap()));
        // Valid films of other samples.
        let reference =
            ["image", "reference", "scene.toml", "--size", "24x16", "--spp", "80", "--out", "out/references"];
        finish(pathmark(folder, &reference)).with_code(0);
        for (half, name) in [("half0", "other.film"), ("half1", "unused.film")] {
            let mut films = fs::read_dir(folder.join("out/references")).unwrap().map(|entry| entry.unwrap().path());
            let film = films.find(|path| path.to_str().unwrap().ends_with(&format!("{half}.film"))).unwrap();
            fs::rename(film, folder.join("out/references").join(name)).unwrap();
        }
        finish(pathmark(folder, &RUN)).with_code(1);
        let failed = rows(folder);
        assert_eq!(failed.len(), 5, "{what}");
        for row in failed {
            assert!(row["error"].contains("has changed since the experiment began"), "{what}: {}", row["error"]);
        }
        // With the old inputs back, the failed rows are run again.
        for (name, bytes) in files {
            fs::write(folder.join(name), bytes).unwrap();
        }
        if deed.contains("references") {
            fs::remove_dir_all(folder.join("out/references")).unwrap();
        }
        finish(pathmark(folder, &[RUN.as_slice(), &["--resume"]].concat())).with_code(0);
        assert_eq!(rows(folder).len(), 5, "{what}");
    }
}

/// Editing the definition has no effect: the sweep uses the text that it has read, and stores it beside its rows.
#[test]
fn an_experiment_edited_under_its_sweep_is_run_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path(), "sed -i s/seed/seat/ tiny.toml");
    let text = fs::read(folder.path().join("tiny.toml")).unwrap();
    finish(pathmark(folder.path(), &RUN)).with_code(0);
    assert!(fs::read(folder.path().join("tiny.toml")).unwrap() != text);
    assert_eq!(fs::read(folder.path().join("out/tiny/experiment.toml")).unwrap(), text);
    assert!(rows(folder.path()).iter().all(|row| row["error"].is_empty()));
}

struct Silence;

impl Progress for Silence {
    fn begin(&self, _: &str, _: u64) {}
    fn advance(&self, _: u64) {}
    fn note(&self, _: &str) {}
    fn end(&self) {}
}

/// Between the sweep's checks and its references nothing has been measured yet, so the sweep ends.
#[test]
fn a_scene_edited_before_its_reference_ends_the_sweep() {
    for name in ["scene.toml", "base.toml", "mesh.obj"] {
        let folder = tempfile::tempdir().unwrap();
        prepare(folder.path(), "true");
        let definition = Definition::load(&Lab::built_in(), folder.path().join("tiny.toml").to_str().unwrap()).unwrap();
        let options = Options { out: folder.path().join("out"), ..Options::default() };
        let sweep = Sweep::new(&definition, &options, &mut Files::default()).unwrap();
        let mut text = fs::read_to_string(folder.path().join(name)).unwrap();
        text.push('\n');
        fs::write(folder.path().join(name), text).unwrap();
        let error = sweep.run(&Silence).expect_err("a refusal");
        assert_eq!(error.exit_code(), 2, "{error}");
        let said = error.to_string();
        assert!(said.contains("has changed since the experiment began") && said.contains(name), "{said}");
    }
}
