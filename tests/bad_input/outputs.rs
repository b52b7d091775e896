//! Outputs that cannot be written are refused before anything is rendered.

use super::program::{finish, in_memory, pathmark, wait};
use super::refused;
use std::fs;
use std::io::Read;

/// Takes longer than the time limit, so a refusal after the render would fail the test.
const LONG: [&str; 4] = ["render", "cornell", "--spp", "4000000"];

#[test]
fn an_output_that_cannot_be_is_refused_before_rendering() {
    let folder = in_memory();
    fs::write(folder.path().join("file"), "kept").unwrap();
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    let long = format!("{}.png", "x".repeat(300));
    let mut cases: Vec<(&str, &[&str])> = vec![
        ("folder.png", &["image", "folder.png", "directory"]),
        ("nowhere/image.png", &["image", "nowhere/image.png", "does not exist"]),
        ("file/image.png", &["image", "file/image.png", "not a directory"]),
        (&long, &["image", "xxx.png", "too long"]),
        ("image.tga", &["image.tga", "png", "ppm", "bmp", "hdr", "exr", "pfm"]),
        ("image", &["image", "png", "pfm"]),
        ("file", &["file", "png", "pfm"]),
        ("", &["image"]),
    ];
    // Other systems have no /dev/full.
    if cfg!(target_os = "linux") {
        std::os::unix::fs::symlink("/dev/full", folder.path().join("full.png")).unwrap();
        cases.push(("full.png", &["image", "full.png", "not a regular file"]));
    }
    for (output, said) in cases {
        println!("{output}");
        refused(folder.path(), &[LONG.as_slice(), &["-o", output]].concat(), 2, said);
    }
    // Each option has its own name in the message.
    for (option, field) in [("--trace", "trace"), ("--checkpoint", "checkpoint")] {
        let said = format!("{field} = nowhere/file: its directory does not exist");
        refused(folder.path(), &[LONG.as_slice(), &[option, "nowhere/file"]].concat(), 2, &[&said]);
    }
    let said = "csv = nowhere/file: its directory does not exist";
    refused(folder.path(), &["inspect", "bounces", "cornell", "--csv", "nowhere/file"], 2, &[said]);
}

/// Linux's /proc refuses new files even from root.
#[cfg(target_os = "linux")]
#[test]
fn refusals_of_the_system_are_system_errors() {
    let folder = in_memory();
    refused(folder.path(), &[LONG.as_slice(), &["-o", "/proc/image.png"]].concat(), 3, &["writing /proc/image.png"]);
    let cases: &[&[&str]] = &[
        &["run", "thread-scaling", "--out", "/proc/new"],
        &["reproduce", "--out", "/proc/new"],
        &["image", "reference", "cornell", "--spp", "4", "--size", "8x8", "--out", "/proc/new"],
    ];
    for arguments in cases {
        refused(folder.path(), arguments, 3, &["/proc/new"]);
    }
}

#[test]
fn an_output_folder_that_is_a_file_is_refused() {
    let folder = in_memory();
    fs::write(folder.path().join("file"), "kept").unwrap();
    let cases: &[&[&str]] = &[
        &["run", "thread-scaling", "--out", "file"],
        &["reproduce", "--out", "file"],
        &["image", "reference", "cornell", "--spp", "4", "--size", "8x8", "--out", "file"],
    ];
    for arguments in cases {
        println!("{arguments:?}");
        refused(folder.path(), arguments, 2, &["out = file: ", "folder"]);
    }
    refused(folder.path(), &["report", "file"], 2, &["folder", "file"]);
}

/// In folders of results, too, the program overwrites neither files that it has not written nor its inputs.
#[test]
fn files_of_others_in_a_folder_of_results_are_kept() {
    let run: &[&str] = &["run", "tiny.toml", "--out", "out"];
    let check: &[&str] = &["selftest", "--out", "out"];
    let cases: &[(&str, &[&str])] = &[
        ("out/report.html", run),
        ("out/tiny/machine.toml", run),
        ("out/tiny/experiment.toml", run),
        ("out/tiny/calibration.csv", run),
        ("out/tiny/notes.txt", run),
        ("out/tiny/machine.toml", &["run", "tiny.toml", "--out", "out", "--resume"]),
        ("out/report.html", &["reproduce", "--out", "out"]),
        ("out/doctor.json", &["reproduce", "--out", "out"]),
        ("out/guards/machine.toml", &["reproduce", "--out", "out", "--resume"]),
        ("out/bursts/machine.toml", &["reproduce", "--out", "out", "--resume", "--reports"]),
        ("out/report.html", check),
        ("out/guards/guards.csv", check),
        ("out/guards/machine.toml", check),
        ("out/check/cases.csv", check),
        ("out/claims/claims.csv", &["claims", "out", "--out", "out"]),
        ("out/CLAIMS.md", &["claims", "out", "--out", "out"]),
        ("out/report.html", &["report", "out"]),
        ("out/report.html/file", run),
        ("out/report.html/file", &["reproduce", "--out", "out"]),
        ("out/report.html/file", check),
        ("out/tiny/records.csv/file", run),
        ("out/guards/guards.csv/file", check),
        ("out/forecast.csv", &["simulate", "out/forecast.csv", "--out", "upper/out"]),
        ("out/forecast-makespan.svg", &["simulate", "out/forecast-makespan.svg", "--out", "out/."]),
    ];
    for (file, arguments) in cases {
        println!("{arguments:?} beside {file}");
        let folder = in_memory();
        super::experiment::write_tiny(folder.path(), super::experiment::TINY);
        std::os::unix::fs::symlink(".", folder.path().join("upper")).unwrap();
        let path = folder.path().join(file);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        if arguments[0] == "simulate" {
            let render = ["render", "cornell", "--size", "8x8", "--spp", "4", "--strategy", "serial"];
            let trace = ["--trace", file, "-o", "image.png"];
            finish(pathmark(folder.path(), &[&render[..], &trace].concat())).with_code(0);
        } else {
            fs::write(path, "the user's").unwrap();
        }
        refused(folder.path(), arguments, 2, &["out"]);
    }
    // An experiment that would be replaced by its copy.
    let folder = in_memory();
    fs::create_dir(folder.path().join("experiment")).unwrap();
    fs::write(folder.path().join("experiment/experiment.toml"), super::experiment::TINY).unwrap();
    refused(folder.path(), &["run", "experiment/experiment.toml", "--out", "."], 2, &["the experiment", "overwritten"]);
}

/// The program may replace its own files: the page of an earlier run.
#[test]
fn pages_of_its_own_are_drawn_again() {
    let folder = in_memory();
    super::experiment::write_tiny(folder.path(), super::experiment::TINY);
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    fs::rename(folder.path().join("out/tiny"), folder.path().join("out/before")).unwrap();
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
}

/// An existing file stays unchanged when the command is refused for another reason.
#[test]
fn a_refused_render_leaves_the_old_image() {
    let folder = in_memory();
    fs::write(folder.path().join("image.png"), "an old image").unwrap();
    refused(folder.path(), &["render", "cornell", "-o", "image.png", "--spp", "6"], 2, &["spp"]);
}

#[test]
fn images_that_cannot_be_compared_are_refused() {
    let folder = in_memory();
    for (size, image) in [("8x8", "a.pfm"), ("8x4", "b.pfm")] {
        let arguments = ["render", "cornell", "--size", size, "--spp", "4", "-o", image];
        finish(pathmark(folder.path(), &arguments)).with_code(0);
    }
    let whole = fs::read(folder.path().join("a.pfm")).unwrap();
    fs::write(folder.path().join("cut.pfm"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.path().join("text.png"), "this is no picture").unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["a.pfm", "b.pfm"], &["8x8", "8x4"]),
        (&["a.pfm", "b.pfm", "--heatmap", "map.png"], &["8x8", "8x4"]),
        (&["a.pfm", "cut.pfm"], &["image", "cut.pfm"]),
        (&["text.png", "a.pfm"], &["image", "text.png"]),
        (&["a.pfm", "a.pfm", "--heatmap", "map.tga"], &["map.tga", "png"]),
        (&["a.pfm", "a.pfm", "--heatmap", "nowhere/map.png"], &["nowhere/map.png", "does not exist"]),
        (&["a.pfm", "."], &["png"]),
        (&["a.pfm", "a.pfm", "b.pfm"], &["8x8", "8x4"]),
        (&["a.pfm", "a.pfm", "--heatmap", "map.png", "--scale", "0"], &["scale = 0", "positive number"]),
        (&["a.pfm", "a.pfm", "--scale", "1"], &["--heatmap"]),
    ];
    for (arguments, said) in cases {
        println!("{arguments:?}");
        refused(folder.path(), &[&["image", "compare"], *arguments].concat(), 2, said);
    }
    for (arguments, said) in [
        (["image", "convert", "a.pfm", "-o", "a.tga"], ["a.tga", "png"]),
        (["image", "convert", "a.film", "-o", "a.png"], ["a.film", "no such file"]),
        (["image", "convert", "text.png", "-o", "a.png"], ["image", "text.png"]),
    ] {
        refused(folder.path(), &arguments, 2, &said);
    }
}

/// `pathmark list | head -1`.
#[test]
fn a_reader_that_has_seen_enough_is_no_failure() {
    let folder = in_memory();
    let cases: [&[&str]; 4] = [&["list"], &["list", "--json"], &["list", "strategies"], &["--help"]];
    for arguments in cases {
        let mut child = pathmark(folder.path(), arguments).spawn().unwrap();
        let mut first = [0];
        let mut out = child.stdout.take().unwrap();
        out.read_exact(&mut first).unwrap();
        drop(out);
        wait(child).with_code(0);

        // The reader closes before the first byte.
        let mut child = pathmark(folder.path(), arguments).spawn().unwrap();
        drop(child.stdout.take());
        wait(child).with_code(0);
    }
}

/// The full disk is Linux's /dev/full.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_the_systems() {
    use super::snapshot;
    use std::fs::File;
    use std::process::Stdio;

    let folder = in_memory();
    let cases: [&[&str]; 3] = [
        &["list"],
        &["list", "scenes", "--json"],
        &["render", "cornell", "--size", "8x8", "--spp", "4", "-o", "a.png", "--json"],
    ];
    for arguments in cases {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let mut command = pathmark(folder.path(), arguments);
        command.stdout(Stdio::from(full));
        let finished = finish(command).with_code(3);
        assert!(finished.err.contains("standard output"), "{}", finished.err);
    }
    let names: Vec<_> = snapshot(folder.path()).into_keys().collect();
    assert_eq!(names, [folder.path().join("a.png")]);
}
