//! Renders in rounds: their reports and their files. `faults/kills.rs` has the kills in between.

use super::{json, run};
use crate::program::{finish, in_memory, pathmark};
use serde_json::Value;
use std::fs;
use std::path::Path;

const SIZE: [&str; 4] = ["render", "cornell", "--size", "48x32"];

fn render(folder: &Path, options: &[&str]) -> Value {
    json(&run(folder, &[SIZE.as_slice(), &["--json"], options].concat()).out)
}

/// Asserts that a render is refused and leaves the folder unchanged.
fn refused(folder: &Path, options: &[&str], said: &[&str]) {
    let files = || {
        let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (fs::read(&path).ok(), path)).collect::<Vec<_>>()
    };
    let before = files();
    let finished = finish(pathmark(folder, &[SIZE.as_slice(), options].concat())).with_code(2);
    assert!(said.iter().all(|text| finished.err.contains(text)), "{said:?} is not in {}", finished.err);
    assert!(finished.out.is_empty() && before == files(), "{options:?}");
}

/// The stopping point is recorded, and a render of as many samples at once has the same checksum.
#[test]
fn goals_are_recorded_and_reproduced() {
    let folder = in_memory();
    for (options, column, value) in
        [(["--target-error", "0.3"], "target_error", 0.3), (["--time-limit", "0.05"], "time_limit_s", 0.05)]
    {
        let found = render(folder.path(), &options);
        assert_eq!(found[column], value);
        assert!(found["rounds"].as_u64() >= Some(1), "{found}");
        let again = render(folder.path(), &["--spp", &found["spp"].to_string()]);
        assert_eq!((&again["checksum"], &again["estimated_rmse"]), (&found["checksum"], &found["estimated_rmse"]));
        assert!(again[column].is_null() && again["rounds"] == 1, "{again}");
        if column == "target_error" {
            assert!(found["rounds"].as_u64() > Some(1), "{found}");
            assert!((0.2..0.3).contains(&found["estimated_rmse"].as_f64().unwrap()), "{found}");
        }
    }
    let adaptive = render(folder.path(), &["--spp", "64", "--adaptive"]);
    assert_eq!((&adaptive["adaptive"], &adaptive["spp"]), (&true.into(), &64.into()));
    assert_eq!(render(folder.path(), &["--spp", "64"])["adaptive"], false);
}

#[test]
fn options_that_contradict_are_refused() {
    let folder = in_memory();
    refused(folder.path(), &["--spp", "16", "--target-error", "0.3"], &["--spp", "--target-error"]);
    refused(folder.path(), &["--adaptive", "--time-limit", "1"], &["--adaptive", "--time-limit"]);
    refused(folder.path(), &["--adaptive", "--spp", "8"], &["spp", "8", "from 16"]);
    refused(folder.path(), &["--target-error", "-1"], &["target-error"]);
    refused(folder.path(), &["--target-error", "0"], &["target-error", "above 0"]);
    refused(folder.path(), &["--time-limit", "NaN"], &["time-limit", "above 0"]);
    refused(folder.path(), &["--target-error", "0.3", "--clamp", "subpixel"], &["clamp", "subpixel", "rounds"]);
    refused(folder.path(), &["--checkpoint", "a.png", "-o", "a.png"], &["checkpoint", "a.png"]);
    refused(folder.path(), &["--checkpoint", "c", "--sampler", "locked"], &["checkpoint", "locked"]);
}

/// A light beyond single precision makes invalid samples. A resumed render counts them as well, and so does a render
/// that finds nothing left to do.
#[test]
fn invalid_samples_are_not_forgotten_on_resume() {
    let folder = in_memory();
    let lamp = "[[objects]]\nname = \"light\"\nemission = [1e60, 1e60, 1e60]\n";
    fs::write(folder.path().join("bright.toml"), format!("about = \"bright\"\nbase = \"cornell\"\n{lamp}")).unwrap();
    let bright = ["render", "bright.toml", "--size", "24x16", "--precision", "f32", "--json"];
    let render = |options: &[&str], code: i32| {
        let finished = finish(pathmark(folder.path(), &[&bright, options].concat())).with_code(code);
        assert_eq!(finished.err.contains("samples were NaN, infinite or negative"), code == 1, "{}", finished.err);
        ["invalid_samples", "samples", "rays", "checksum"].map(|column| json(&finished.out)[column].clone())
    };
    let expected = render(&["--spp", "20", "--strict"], 1);
    assert!(expected[0].as_u64() > Some(0), "{expected:?}");
    for _ in 0..2 {
        assert_eq!(render(&["--spp", "20", "--checkpoint", "c", "--strict"], 1), expected);
    }
    // Twice the samples, resumed and rendered at once.
    let longer = render(&["--spp", "40", "--checkpoint", "c"], 0);
    assert_eq!(longer, render(&["--spp", "40"], 0));
    assert!(longer[0].as_u64() > expected[0].as_u64());
}

/// A checkpoint can be resumed with more samples, and with no other change of the image.
#[test]
fn a_checkpoint_is_of_one_render() {
    let folder = in_memory();
    let with = |options: &[&'static str]| [&["--checkpoint", "c"], options].concat();
    render(folder.path(), &with(&["--spp", "20"]));
    let longer = render(folder.path(), &with(&["--spp", "52"]));
    assert_eq!(longer["checksum"], render(folder.path(), &["--spp", "52"])["checksum"]);
    assert!(longer["warnings"].as_str().unwrap().contains("resumed(at 20 spp)"), "{longer}");
    // The strategy and the decomposition may differ.
    let other =
        render(folder.path(), &with(&["--spp", "80", "--strategy", "serial", "--decomposition", "samples:16:8x8"]));
    assert_eq!(other["checksum"], render(folder.path(), &["--spp", "80"])["checksum"]);

    refused(folder.path(), &with(&["--spp", "76"]), &["spp", "76", "80"]);
    // A goal goes on from there, too.
    let goal = render(folder.path(), &["--checkpoint", "c", "--target-error", "0.1"]);
    assert_eq!(goal["checksum"], render(folder.path(), &["--spp", &goal["spp"].to_string()])["checksum"]);
    assert!(goal["spp"].as_u64() > Some(80), "{goal}");
    for (options, said) in [
        (["--size", "48x32", "--seed", "2"], "seed"),
        (["--size", "32x48", "--seed", "1"], "height"),
        (["--size", "48x32", "--estimator", "bsdf"], "estimator"),
        (["--size", "48x32", "--max-depth", "9"], "max_depth"),
        (["--size", "48x32", "--camera-rays", "4"], "camera_rays"),
    ] {
        let arguments = [&["render", "cornell", "--checkpoint", "c", "--spp", "120"], options.as_slice()].concat();
        let before = fs::read(folder.path().join("c")).unwrap();
        let finished = finish(pathmark(folder.path(), &arguments)).with_code(2);
        assert!(finished.err.contains("another render") && finished.err.contains(said), "{}", finished.err);
        assert!(fs::read(folder.path().join("c")).unwrap() == before);
    }
    let scene = ["render", "wada", "--size", "48x32", "--checkpoint", "c", "--spp", "120"];
    assert!(finish(pathmark(folder.path(), &scene)).with_code(2).err.contains("scene"));
}

/// A checkpoint that has lost or gained a byte, or is no checkpoint, is refused and kept.
#[test]
fn a_damaged_checkpoint_is_refused_and_kept() {
    let folder = in_memory();
    let options = ["--checkpoint", "c", "--spp", "40"];
    render(folder.path(), &options);
    let path = folder.path().join("c");
    let whole = fs::read(&path).unwrap();
    let lengths = [0, 1, 21, 22, 23, 40, 300, whole.len() / 2, whole.len() - 33, whole.len() - 1];
    let mut damaged: Vec<Vec<u8>> = lengths.map(|length| whole[..length].to_vec()).into();
    damaged.push([&whole, b"x".as_slice()].concat());
    damaged.push(b"not a checkpoint, but somebody's only copy of something".to_vec());
    for at in (0..whole.len()).step_by(whole.len() / 4) {
        let mut flipped = whole.clone();
        flipped[at] ^= 1;
        damaged.push(flipped);
    }
    for bytes in damaged {
        fs::write(&path, &bytes).unwrap();
        refused(folder.path(), &options, &["checkpoint", "c"]);
    }
    fs::write(&path, &whole).unwrap();
    assert_eq!(render(folder.path(), &options)["rounds"], 0);
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    refused(folder.path(), &options, &["directory"]);
}

/// `--until` doubles both halves; a longer reference resumes from a shorter one, with the bits of a reference rendered
/// at once.
#[test]
fn a_reference_is_refined_and_extended() {
    let folder = in_memory();
    let reference = |options: &[&str]| {
        let finished = run(folder.path(), &[&["image", "reference", "cornell", "--size", "24x16"], options].concat());
        let films: Vec<String> = finished.out.lines().take(2).map(str::to_string).collect();
        let (by_variance, by_difference) = finished.out.trim_end().rsplit_once(" by variance, ").unwrap();
        let number = |text: &str| text.split(' ').next_back().unwrap().parse::<f64>().unwrap();
        let errors = [number(by_variance), number(by_difference.trim_end_matches(" by difference"))];
        (films, errors, finished.err)
    };
    let bytes = |film: &String| fs::read(folder.path().join(film)).unwrap();
    let (coarse, errors, _) = reference(&["--until", "0.2"]);
    assert!(errors.iter().all(|error| (0.05..=0.2).contains(error)), "{errors:?}");
    // The two error estimates agree: over 384 pixels, the difference is known to some percent.
    assert!((0.8..1.25).contains(&(errors[0] / errors[1])), "{errors:?}");
    let (fine, errors, said) = reference(&["--until", "0.1"]);
    assert!(errors.iter().all(|error| (0.025..=0.1).contains(error)) && fine != coarse, "{errors:?}");
    assert!(!said.contains("at 16 spp"), "it goes on from what is there: {said}");
    // Intermediate films are removed, the films of the first call are not.
    assert_eq!(fs::read_dir(folder.path().join("out/references")).unwrap().count(), 4);
    let (odd, _, _) = reference(&["--spp", "300"]);
    let fresh = reference(&["--spp", "300", "--out", "fresh"]).0;
    let name = fine[0].split('-').find_map(|part| part.strip_suffix("spp")).unwrap().to_string();
    let same = reference(&["--spp", &name, "--out", "fresh"]).0;
    for (found, expected) in odd.iter().zip(&fresh).chain(fine.iter().zip(&same)) {
        assert!(found != expected && bytes(found) == bytes(expected), "{found}");
    }
    for options in [["--until", "0"], ["--until", "NaN"]] {
        let arguments = [&["image", "reference", "cornell", "--out", "none"], options.as_slice()].concat();
        assert!(finish(pathmark(folder.path(), &arguments)).with_code(2).err.contains("until"));
    }
    assert!(!folder.path().join("none").exists());
}
