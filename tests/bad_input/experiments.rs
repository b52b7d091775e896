//! Wrong experiment files: refused before the first cell, with nothing in the output folder.

use super::experiment::{TINY, write_tiny};
use super::{line_of, place, refused};

const REFERENCE: &str = "\n[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n";

/// The text to replace, its replacement, and the words that the message must contain.
const WRONG: &[(&str, &str, &[&str])] = &[
    ("strategy = [\"serial\"", "strategy = [\"stealth\"", &["strategy", "stealth", "work-stealing"]),
    ("strategy = [\"serial\"", "strategy = [\"dynamic:0\"", &["strategy", "dynamic:0", "from 1"]),
    (
        "estimator = [\"smallpt\"]",
        "estimator = [\"smallpt\"]\nsampler = [\"libc-rand\"]",
        &["sampler", "libc-rand", "checksum", "independent"],
    ),
    ("spp = [4]", "spp = [4]\noutput = [\"pigeon\"]", &["output", "pigeon", "slots"]),
    ("spp = [4]", "spp = [4]\noutput = []", &["output"]),
    ("size = [24, 16]", "size = [24, 16, 4]", &["size", "length 3", "length 2"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\nchapter = \"sports\"", &["chapter", "sports", "accuracy", "scheduling"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\nplace = -1", &["place", "-1"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\nin-short = 0", &["in-short", "0"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\nrequires = [\"abacus\"]", &["requires", "abacus", "openmp"]),
    ("spp = [4]", "spp = [4]\nprofiles = [\"huge\"]", &["profiles", "huge", "quick", "full", "reports"]),
    ("spp = [4]", "spp = [4]\nprofiles = \"full\"", &["profiles", "full", "sequence"]),
    ("spp = [4]", "spp = [4]\nprofiles = [\"reports\"]", &["profiles", "reports", "[reports]", "quick, full"]),
    ("spp = [4]", "spp = [4]\nprofiles = [\"full\"]", &["profiles", "no matrix", "quick"]),
    ("spp = [4]", "spp = [4]\nprofiles = []", &["profiles", "no matrix", "quick"]),
    ("tiles:8x8", "samples:24", &["decomposition", "samples:24", "samples:16"]),
    ("estimator = [\"smallpt\"]", "estimator = [\"magic\"]", &["estimator", "magic", "smallpt"]),
    (
        "estimator = [\"smallpt\"]",
        "estimator = [\"smallpt\"]\nsampler = [\"dice\"]",
        &["sampler", "dice", "independent"],
    ),
    ("scene = [\"cornell\"]", "scene = [\"bathroom\"]", &["scene", "bathroom", "cornell"]),
    (
        "scene = [\"cornell\"]\nestimator = [\"smallpt\"]",
        "scene = [\"bathroom\"]\nestimator = [\"default\"]",
        &["scene", "bathroom", "cornell"],
    ),
    ("tiles:8x8", "hexagons", &["decomposition", "hexagons", "tiles:32x32"]),
    ("figures = [\"speedup\", ", "figures = [\"pie-chart\", ", &["figures", "pie-chart", "speedup"]),
    ("spp = [4]", "spp = [0]", &["spp", "0", "1 to"]),
    ("spp = [4]", "spp = [6]", &["spp", "6", "multiple of 4"]),
    ("spp = [4]", "spp = [-4]", &["spp", "-4", "u32"]),
    ("spp = [4]", "spp = 4", &["spp", "4", "sequence"]),
    ("spp = [4]", "spp = []", &["spp"]),
    ("threads = [1, 2]", "threads = []", &["threads"]),
    ("scene = [\"cornell\"]", "scene = []", &["scene"]),
    ("threads = [1, 2]", "threads = [0]", &["threads", "0", "1 to"]),
    ("threads = [1, 2]", "threads = [1000000]", &["threads", "1000000", "1 to"]),
    ("threads = [1, 2]", "threads = [\"many\"]", &["threads", "many", "all"]),
    ("threads = [1, 2]", "threads = [-1]", &["threads", "-1"]),
    ("seed = [1]", "seed = [9223372036854775808]", &["seed", "9223372036854775808"]),
    ("seed = [1]", "seed = [1]\nseed = [2]", &["seed", "duplicate"]),
    ("seed = [1]", "seeds = [1]", &["seeds", "seed"]),
    ("seed = [1]", "seed = [1]\nadaptive = [\"often\"]", &["adaptive", "often", "boolean"]),
    ("spp = [4]", "spp = [4]\nadaptive = [true]", &["spp", "4", "multiples of 4 from 16"]),
    ("spp = [4]", "spp = [64]\nadaptive = [true]\ncurve = true", &["adaptive", "true", "curves"]),
    ("spp = [4]", "spp = [64]\nadaptive = [true]\ntime-limit = [1.0]", &["adaptive", "true", "in rounds"]),
    ("spp = [4]", "spp = [4]\ncurve = true\ntime-limit = [1.0]", &["curve", "true", "no time-limit"]),
    ("spp = [4]", "spp = [4, 8]\ntime-limit = [1.0]", &["spp", "2 values", "most samples"]),
    ("seed = [1]", "seed = [1]\ntime-limit = [0.0]", &["time-limit", "0", "above 0"]),
    ("seed = [1]", "seed = [1]\ntime-limit = [-1]", &["time-limit", "-1", "above 0"]),
    ("seed = [1]", "seed = [1]\ntime-limit = [nan]", &["time-limit", "NaN", "above 0"]),
    ("seed = [1]", "seed = [1]\ntime-limit = [\"1 s\"]", &["time-limit", "1 s", "f64"]),
    ("seed = [1]", "seed = [1]\ntime-limit = []", &["time-limit", "no values"]),
    ("spp = [4]\n", "", &["spp", "missing"]),
    ("size = [24, 16]", "size = [0, 16]", &["size", "0x16", "1x1 to"]),
    ("size = [24, 16]", "size = [1000000000, 1000000000]", &["size", "1000000000x1000000000", "1x1 to"]),
    ("size = [24, 16]", "size = [24]", &["size", "24"]),
    ("repetitions = 3", "repetitions = 0", &["repetitions", "0", "1 to 10000"]),
    ("repetitions = 3", "repetitions = 4294967295", &["repetitions", "4294967295", "1 to 10000"]),
    (
        "repetitions = 3",
        "repetitions = { until = \"3 %\", at-most = 4294967295 }",
        &["repetitions", "4294967295", "1 to 10000"],
    ),
    ("title = \"Tiny\"", "title = \"Tiny\"\ntimeout = \"soon\"", &["timeout", "soon", "10min, or none"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\ntimeout = 60", &["timeout", "60", "string"]),
    ("title = \"Tiny\"", "title = \"Tiny\"\ntimeout = \"0s\"", &["timeout", "0s", "above 0"]),
    ("repetitions = 3", "repetitions = 3\ntimeout = \"-1s\"", &["timeout", "-1s", "above 0"]),
    ("repetitions = 3", "repetitions = 3\ntimeout = \"60\"", &["timeout", "60", "with its unit"]),
    (
        "size = [24, 16]",
        "size = [24, 16]\nspp = [16777216]\ndecomposition = [\"samples:16:1x1\"]",
        &["decomposition", "samples:16:1x1", "402653184 jobs", "larger tiles"],
    ),
    ("title = \"Tiny\"", "title = \"Tiny\"\nmood = \"good\"", &["mood", "title"]),
    ("title = \"Tiny\"", "title = Tiny", &["title"]),
];

/// Puts `wrong` in place of `right`; returns whether the refusal points at its lines.
fn check(base: &str, right: &str, wrong: &str, options: &[&str], said: &[&str]) -> bool {
    assert!(base.contains(right), "{right:?}");
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &base.replacen(right, wrong, 1));
    let changed = line_of(base, right)..=line_of(base, right) + wrong.matches('\n').count();
    // A missing field is reported where its table begins.
    let table = line_of(base, "[matrix]");
    let arguments = [&["run", "tiny.toml", "--out", "new"], options].concat();
    std::panic::catch_unwind(|| {
        let message = refused(folder.path(), &arguments, 2, said);
        let line = place(&message, "tiny.toml").map(|at| at.0);
        let pointed = line.is_some_and(|line| changed.contains(&line) || (wrong.is_empty() && line == table));
        assert!(pointed, "{wrong:?} not in lines {changed:?}: {message}");
    })
    .is_ok()
}

#[test]
fn each_wrong_experiment_is_refused_at_its_place() {
    let failed = WRONG.iter().filter(|(right, wrong, said)| !check(TINY, right, wrong, &[], said));
    // All cases run before any failure is reported, so that one run shows all of them.
    let failed: Vec<_> = failed.map(|(_, wrong, _)| wrong).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

/// Combinations multiply: no list need be long.
#[test]
fn too_many_cells_are_refused() {
    let numbers: Vec<String> = (1..=2001).map(|number| number.to_string()).collect();
    let seeds = format!("seed = [{}]", numbers.join(", "));
    assert!(check(TINY, "seed = [1]", &seeds, &[], &["seed", "2001 values", "12006 combinations", "at most 10000"]));
    let named = "name = \"other\"\nseed = [1]";
    let rest = "scene = \"cornell\"\nspp = [4, 8, 12, 16, 20, 24]\ncommand = [\"{spp}\", \"{seed}\", \"{out}\"]";
    let base = TINY.replace("[quick]\n", &format!("[[external]]\n{named}\n{rest}\n\n[quick]\n"));
    let many = format!("name = \"other\"\n{seeds}");
    assert!(check(&base, named, &many, &[], &["name", "other", "at most 10000 cells"]));
}

/// A fault in one profile is not reported at the same field of the other.
#[test]
fn a_fault_in_the_full_profile_is_shown_there() {
    let base = TINY.replace("repetitions = 3", "repetitions = 30");
    assert!(check(&base, "repetitions = 10", "repetitions = 0", &["--full"], &["repetitions", "0"]));
    assert!(check(TINY, "size = [32, 16]", "size = [0, 16]", &["--full"], &["size", "0x16"]));
}

/// The message names the missing profile and the existing ones.
#[test]
fn a_profile_that_is_not_there_is_refused() {
    let (head, quick) = TINY.split_once("[quick]").unwrap();
    let (quick, full) = quick.split_once("[full]").unwrap();
    let folder = tempfile::tempdir().unwrap();
    let refuse = |text: &str, option: &[&str], said: &[&str]| {
        write_tiny(folder.path(), text);
        refused(folder.path(), &[&["run", "tiny.toml", "--out", "new"], option].concat(), 2, said);
    };
    for option in ["--full", "--reports"] {
        refuse(head, &[option], &["tiny.toml", "profile", "(allowed: --quick)"]);
    }
    refuse(TINY, &["--reports"], &["tiny.toml", "reports", "--quick, --full"]);
    refuse(&format!("{head}[quick]{quick}"), &["--full"], &["tiny.toml", "full", "(allowed: --quick)"]);
    refuse(&format!("{head}[full]{full}"), &[], &["tiny.toml", "quick", "(allowed: --full)"]);
    refuse(&format!("{head}[full]{full}"), &["--full", "--reports"], &["--full", "--reports"]);
}

/// A reference that is impossible, or too coarse to measure anything with.
#[test]
fn each_wrong_reference_is_refused_at_its_place() {
    let base = TINY.replace("\n[quick]\n", REFERENCE);
    let cases: &[(&str, &str, &[&str])] = &[
        ("estimator = \"bsdf\"", "estimator = \"bsdf\"\nobject = \"piano\"", &["object", "piano", "mirror ball"]),
        ("estimator = \"bsdf\"", "estimator = \"bsdf\"\nobject = 7", &["object", "7", "string"]),
        ("reference-spp = 40", "reference-spp = 39", &["reference-spp", "39", "40"]),
        ("reference-spp = 40", "reference-spp = 0", &["reference-spp", "0", "40"]),
        ("reference-spp = 40", "reference-spp = 4000000000", &["spp", "4000000000", "1 to"]),
        ("estimator = \"bsdf\"", "estimator = \"magic\"", &["estimator", "magic", "bsdf"]),
        ("estimator = \"bsdf\"", "estimater = \"bsdf\"", &["estimater", "estimator"]),
    ];
    let failed = cases.iter().filter(|(right, wrong, said)| !check(&base, right, wrong, &[], said));
    let failed: Vec<_> = failed.map(|(_, wrong, _)| wrong).collect();
    assert!(failed.is_empty(), "{failed:?}");
}

/// The experiment's folder, in the folder of results, takes the experiment's name: a name that leads elsewhere is
/// refused.
#[test]
fn names_that_lead_elsewhere_are_refused() {
    for name in [
        "...toml",
        "..toml",
        "bursts.toml",
        "earlier.toml",
        "guards.toml",
        "index.toml",
        "pages.toml",
        "references.toml",
        "report.html.toml",
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), TINY).unwrap();
        refused(folder.path(), &["run", name, "--out", "results/out"], 2, &["experiment", name, "another file name"]);
    }
}

/// Invalid values for `--set`, and a figure that would have nothing to compare with.
#[test]
fn values_that_cannot_be_set_are_refused() {
    let wrong: &[(&str, &[&str])] = &[
        ("threads", &["set = threads", "AXIS=VALUE"]),
        ("speed=3", &["set = speed", "there is no axis", "threads"]),
        ("thread=3", &["did you mean threads?"]),
        ("spp=many", &["spp = many", "whole number"]),
        ("spp=", &["set = spp=", "empty value", "AXIS=VALUE"]),
        ("reference-spp=", &["set = reference-spp=", "empty value"]),
        ("threads=1,,2", &["set = threads=1,,2", "empty value"]),
        ("size=20", &["size = 20", "WxH"]),
        ("size=20x0", &["size = 20x0", "1x1 to"]),
        ("reference-spp=few", &["reference-spp = few", "whole number"]),
        ("scene=bathroom", &["scene = bathroom", "cornell"]),
        ("strategy=work-stealing", &["strategy", "`speedup` compares with serial runs", "serial beside"]),
    ];
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    for (value, said) in wrong {
        let message = refused(folder.path(), &["run", "tiny.toml", "--out", "new", "--set", value], 2, said);
        assert_eq!(place(&message, "tiny.toml"), None, "a line of a text that the user has not seen: {message}");
    }
}

/// A scene's file in the current folder, and another one of that name beside the experiment.
#[test]
fn a_scene_of_two_files_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let beside = folder.path().join("experiments");
    std::fs::create_dir(&beside).unwrap();
    write_tiny(&beside, TINY);
    for place in [folder.path(), &beside] {
        std::fs::write(place.join("room.toml"), "base = \"cornell\"\n").unwrap();
    }
    let run = ["run", "experiments/tiny.toml", "--out", "new", "--set", "scene=room.toml"];
    refused(folder.path(), &run, 2, &["scene = room.toml", "one file here and another one beside the experiment"]);
}
