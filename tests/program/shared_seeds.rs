//! M04: an image that shares samples with its reference looks better than it is, and two equal halves leave the
//! reference's noise in the cross form. Every command that measures errors refuses both.

use crate::program::{Finished, finish, in_memory, pathmark, wait};
use pathmark::experiment::{CellJob, HalfFile, PointJob, SceneVersion, reference_seed};
use pathmark::film_file::read_film;
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Stdio;

fn halves(folder: &Path) -> [PathBuf; 2] {
    let reference = ["image", "reference", "cornell", "--spp", "4", "--size", "16x12", "--out", "films", "--quiet"];
    finish(pathmark(folder, &reference)).with_code(0);
    let mut films: Vec<PathBuf> =
        std::fs::read_dir(folder.join("films")).unwrap().map(|film| film.unwrap().path()).collect();
    films.sort();
    films.try_into().unwrap()
}

/// The answer of a sweep's child for an image of this seed against these halves.
fn measured(folder: &Path, seed: u64, references: [PathBuf; 2]) -> Finished {
    let settings = Settings {
        scene: "cornell".to_string(),
        spp: 4,
        spec: Spec { width: 16, height: 12, seed, estimator: "bsdf".to_string(), ..Spec::default() },
        decomposition: "rows".to_string(),
        strategy: "serial".to_string(),
        threads: 1,
        ..Settings::default()
    };
    let half = |path: PathBuf| HalfFile { checksum: read_film(&path).unwrap().1.checksum(), path };
    let job = CellJob {
        experiment: "shared-seeds".to_string(),
        points: vec![PointJob { cell: "one".to_string(), spp: 4, image: None }],
        scene: SceneVersion::of(&Setup::prepare(settings.clone()).unwrap()),
        settings,
        references: Some(references.map(half)),
        ..CellJob::default()
    };
    let mut command = pathmark(folder, &["cell"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    // Open until the end: a child whose input closes assumes that its parent has died.
    let mut input = child.stdin.take().unwrap();
    writeln!(input, "{}", serde_json::to_string(&job).unwrap()).unwrap();
    let finished = wait(child);
    drop(input);
    finished
}

#[test]
fn shared_seeds_are_refused() {
    let folder = in_memory();
    let [first, second] = halves(folder.path());
    let fine = measured(folder.path(), 1, [first.clone(), second.clone()]).with_code(0);
    assert!(fine.out.contains("\"mse\":"), "{}", fine.out);
    for (seed, references) in [
        (reference_seed(0), [first.clone(), second.clone()]),
        (reference_seed(1), [first.clone(), second]),
        (1, [first.clone(), first]),
    ] {
        let refused = measured(folder.path(), seed, references).with_code(2);
        assert!(refused.err.contains("three different seeds") && refused.out.is_empty(), "{}", refused.err);
    }
}

/// `compare` reads film files, which record their seeds.
#[test]
fn films_of_one_seed_are_not_compared() {
    let folder = in_memory();
    let [first, second] = halves(folder.path());
    let compared = |image: &Path, reference: &Path| {
        let arguments = ["image".as_ref(), "compare".as_ref(), image.as_os_str(), reference.as_os_str()];
        finish(pathmark(folder.path(), &arguments))
    };
    let fine = compared(&first, &second).with_code(0);
    assert!(fine.out.starts_with("mse") && !fine.out.contains("rmse  0 "), "{}", fine.out);
    // A copy under another name, and a film with more samples of the same seed.
    let copy = folder.path().join("copy.film");
    fs::copy(&first, &copy).unwrap();
    let longer = ["image", "reference", "cornell", "--spp", "16", "--size", "16x12", "--out", "films", "--quiet"];
    let longer = finish(pathmark(folder.path(), &longer)).with_code(0).out;
    for other in [copy, folder.path().join(longer.lines().next().unwrap())] {
        let refused = compared(&first, &other).with_code(2);
        assert!(refused.err.contains("share samples") && refused.out.is_empty(), "{}", refused.err);
    }
}
