//! Other programs in an experiment's tables: their image is read and measured, their process is timed, and a missing
//! program stops nothing.

use crate::experiment::{TINY, write_tiny};
use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

/// Runs the small experiment with one more table. Returns the rows of `other` and the finished program.
fn run(folder: &Path, external: &str) -> (Vec<BTreeMap<String, String>>, Finished) {
    let (matrix, scales) = TINY.split_once("[quick]").unwrap();
    let scales = scales.replacen("repetitions = 3", "repetitions = 1\nreference-spp = 40", 1);
    let text = format!("{matrix}[reference]\nestimator = \"bsdf\"\n\n{external}\n[quick]{scales}");
    write_tiny(folder, &text);
    let finished = finish(pathmark(folder, &["run", "tiny.toml", "--out", "out"]));
    let rows = csv::Reader::from_path(folder.join("out/tiny/records.csv")).map_or_else(
        |_| Vec::new(),
        |mut reader| reader.deserialize().map(|row| row.unwrap()).collect::<Vec<BTreeMap<String, String>>>(),
    );
    (rows.into_iter().filter(|row| row["estimator"] == "other").collect(), finished)
}

pub(crate) fn table(command: &str) -> String {
    format!("[[external]]\nname = \"other\"\nscene = \"cornell\"\nspp = [8]\nseed = [3, 4]\ncommand = [{command}]\n")
}

/// A black image of 24x16 pixels: three floats each.
const BLACK: &str = r#""sh", "-c", "(printf 'PF\\n24 16\\n-1.0\\n'; head -c 4608 /dev/zero) > $0; sleep 0.05", "{out}", "{spp}", "{seed}""#;

#[test]
fn its_image_is_measured_and_its_process_timed() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, finished) = run(folder.path(), &table(BLACK));
    finished.with_code(0);
    let seeds: Vec<&str> = rows.iter().map(|row| row["seed"].as_str()).collect();
    assert_eq!(rows.len(), 2, "{seeds:?}");
    for row in &rows {
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert!(number("makespan_s") >= 0.05, "the process sleeps that long: {}", row["makespan_s"]);
        assert!(number("cpu_user_s") + number("cpu_system_s") < number("makespan_s"), "and uses no processor for it");
        // For a black image, the squared error is the picture's mean square, which is above the square of its mean,
        // 0.33.
        assert!(number("mse") > 0.33 * 0.33 && number("mean_radiance") == 0.0, "{}", row["mse"]);
        assert_eq!((row["sampler"].as_str(), row["spp"].as_str(), row["error"].as_str()), ("external", "8", ""));
    }
}

/// A program may tell the seconds of its rendering, so that its start and its writing are not its price.
#[test]
fn one_that_tells_its_seconds_is_believed_within_its_run() {
    let telling =
        |seconds: &str| BLACK.replace("sleep 0.05", &format!("sleep 0.05; echo start; echo seconds = {seconds}"));
    let folder = tempfile::tempdir().unwrap();
    let (rows, finished) = run(folder.path(), &table(&telling("0.02")));
    finished.with_code(0);
    for row in &rows {
        assert_eq!(row["makespan_s"], "0.02");
        assert!(row["kernel_build_s"].parse::<f64>().unwrap() >= 0.03, "{}", row["kernel_build_s"]);
    }
    for wrong in ["1000", "-1", "0", "nan", "soon"] {
        let folder = tempfile::tempdir().unwrap();
        let (rows, finished) = run(folder.path(), &table(&telling(wrong)));
        finished.with_code(1);
        let told = format!("external = other: tells `seconds = {wrong}`, which is no time within its");
        assert!(rows.iter().all(|row| row["error"].contains(&told)), "{}", rows[0]["error"]);
    }
}

#[test]
fn a_program_that_is_not_there_is_said_and_stops_nothing() {
    for command in [
        r#""./nowhere/renderer", "{out}", "{spp}", "{seed}""#,
        r#""env", "A=B", "nowhere-renderer", "{out}", "{spp}", "{seed}""#,
    ] {
        let folder = tempfile::tempdir().unwrap();
        let build = "build = [\"nowhere-compiler\", \"{folder}/renderer\"]\n";
        let (rows, finished) = run(folder.path(), &format!("{}{build}", table(command)));
        assert!(finished.err.contains("other is left out"), "{}", finished.err);
        let finished = finished.with_code(0);
        let last = finished.err.lines().last().unwrap_or_default();
        assert_eq!(last, "left out: 2 rows of other: its program is not on this machine");
        assert!(finished.out.contains("7 rows (2 left out)"), "{}", finished.out);
        let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        let box_of = "<div class=\"failed\"><p><strong>Left out: 2 rows.</strong>";
        assert!(page.contains(box_of) && page.contains("2 rows of other: its program is not on this machine"));
        assert!(page.contains("5 done, 0 failed, 2 left out"), "{page}");
        assert_eq!(rows.len(), 2);
        assert!(rows.iter().all(|row| row["warnings"] == "no-program" && row["makespan_s"].is_empty()));
    }
}

/// A program that was missing is run when the sweep is resumed and the program is there.
#[test]
fn one_that_was_missing_is_run_when_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, _) = run(folder.path(), &table(r#""./later", "{out}", "{spp}", "{seed}""#));
    assert!(rows.iter().all(|row| row["warnings"] == "no-program"));
    std::fs::write(folder.path().join("later"), "#!/bin/sh\nexit 3\n").unwrap();
    std::fs::set_permissions(folder.path().join("later"), std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let resumed = finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out", "--resume"])).with_code(1);
    assert!(resumed.err.contains("external = other: ended with exit status: 3"), "{}", resumed.err);
    assert!(!resumed.err.contains("left out"), "{}", resumed.err);
}

/// Of a traceback the last line says what is wrong. All rows fail in the same way, so it is told once.
#[test]
fn one_that_fails_or_writes_another_size_is_a_failed_row() {
    for (command, why) in [
        (
            r#""sh", "-c", "printf 'Traceback\\n  line 3\\nout of paint\\n\\n' >&2; exit 3", "{out}", "{spp}", "{seed}""#,
            "external = other: ended with exit status: 3: out of paint",
        ),
        (r#""sh", "-c", "", "{out}", "{spp}", "{seed}""#, "external = other: wrote no image"),
        (
            r#""sh", "-c", "echo no picture > $0", "{out}", "{spp}", "{seed}""#,
            "external = other: wrote an image that cannot be read",
        ),
        (r#""sh", "-c", "printf 'PF\\n1 1\\n-1.0\\n000000000000' > $0", "{out}", "{spp}", "{seed}""#, "1x1"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let (rows, finished) = run(folder.path(), &table(command));
        let finished = finished.with_code(1);
        assert_eq!(rows.len(), 2);
        assert!(rows.iter().all(|row| row["error"].contains(why)), "{}", rows[0]["error"]);
        assert!(finished.err.matches(why).count() == 1 && !finished.err.contains("Traceback"), "{}", finished.err);
        assert!(finished.err.contains("2 of 7 rows failed"), "{}", finished.err);
        let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
        assert!(page.matches(why).count() == 1 && page.contains("and 1 more"), "{page}");
    }
}

/// A sample count that is listed twice, as by the curves of two lists, gives one row; a resumed sweep finds all rows.
#[test]
fn a_doubled_number_of_samples_is_one_row() {
    let folder = tempfile::tempdir().unwrap();
    let table = table(BLACK).replace("spp = [8]", "spp = [8, 16, 8]\ncurve = true\nfewest-spp = 4");
    let (rows, finished) = run(folder.path(), &table);
    finished.with_code(0);
    // 4, 8 and 16 samples, two seeds each.
    assert_eq!(rows.len(), 6);
    let rows = || std::fs::read(folder.path().join("out/tiny/records.csv")).unwrap();
    let before = rows();
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out", "--resume"])).with_code(0);
    assert!(rows() == before, "there was nothing to resume");
}

/// The size is checked even if no reference has to match it.
#[test]
fn an_image_of_another_size_is_a_failed_row_without_references() {
    let folder = tempfile::tempdir().unwrap();
    let small = r#""sh", "-c", "printf 'PF\\n1 1\\n-1.0\\n000000000000' > $0", "{out}", "{spp}", "{seed}""#;
    let text = TINY.replace("[quick]\n", &format!("{}\n[quick]\n", table(small)));
    write_tiny(folder.path(), &text);
    let failed = finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(1);
    assert!(failed.err.contains("size = 1x1") && failed.err.contains("24x16"), "{}", failed.err);
}

/// Images of two sizes are each measured against their own reference.
#[test]
fn every_size_has_its_reference() {
    let folder = tempfile::tempdir().unwrap();
    let (_, matrix) = TINY.split_once("[matrix]").unwrap();
    let (matrix, _) = matrix.split_once("[quick]").unwrap();
    let two = format!("[[matrix]]{matrix}\n[[matrix]]\nsize = [8, 6]{matrix}");
    let reference = "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n";
    let text = TINY.replace(&format!("[matrix]{matrix}"), &two).replace("[quick]\n", reference);
    write_tiny(folder.path(), &text);
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    let rows = csv::Reader::from_path(folder.path().join("out/tiny/records.csv")).unwrap().into_deserialize();
    let rows: Vec<BTreeMap<String, String>> = rows.map(Result::unwrap).collect();
    for width in ["8", "24"] {
        let of: Vec<_> = rows.iter().filter(|row| row["width"] == width).collect();
        assert!(!of.is_empty() && of.iter().all(|row| row["error"].is_empty() && !row["mse"].is_empty()), "{width}");
    }
}

#[test]
fn a_command_without_a_place_for_the_seed_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (rows, finished) = run(folder.path(), &table(r#""renderer", "{out}", "{spp}""#));
    let refused = finished.with_code(2);
    assert!(refused.err.contains("command") && refused.err.contains("{seed}") && rows.is_empty(), "{}", refused.err);
}

/// Whether a process runs; an ended process that nobody has waited for does not.
pub(crate) fn runs(process: &str) -> bool {
    if cfg!(target_os = "linux") {
        let status = std::fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
        return status.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with('Z'));
    }
    // Other systems have no /proc, and always have `ps`, which small Linux systems lack.
    let told = Command::new("ps").args(["-o", "stat=", "-p", process]).output().unwrap();
    let state = String::from_utf8_lossy(&told.stdout);
    !state.trim().is_empty() && !state.starts_with('Z')
}

/// Neither the other program nor its children outlive the sweep or the cell, however these end.
#[test]
fn it_ends_with_the_sweep() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    // The ids of its own process, of its child, and of its parent, the cell.
    let command =
        r#""sh", "-c", "sleep 1000 & echo $$ $! $PPID > pids.tmp; mv pids.tmp pids; wait", "{out}", "{spp}", "{seed}""#;
    for (signal, victim) in
        [(Signal::SIGTERM, None), (Signal::SIGKILL, None), (Signal::SIGTERM, Some(2)), (Signal::SIGKILL, Some(2))]
    {
        watchdog.now(format!("after {signal} to {victim:?}"));
        let folder = tempfile::tempdir().unwrap();
        let text = TINY.replace("[quick]", &format!("{}\n[quick]", table(command).replace("[3, 4]", "[3]")));
        write_tiny(folder.path(), &text.replace("repetitions = 3", "repetitions = 1"));
        let mut sweep = pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"]).spawn().unwrap();
        let path = folder.path().join("pids");
        while !path.exists() {
            assert!(sweep.try_wait().unwrap().is_none(), "the sweep ends with its cells");
            std::thread::sleep(Duration::from_millis(5));
        }
        let text = std::fs::read_to_string(path).unwrap();
        let pids: Vec<&str> = text.split_whitespace().collect();
        let victim = victim.map_or_else(|| sweep.id().to_string(), |index: usize| pids[index].to_string());
        kill(Pid::from_raw(victim.parse().unwrap()), signal).unwrap();
        while pids.iter().any(|process| runs(process)) {
            std::thread::sleep(Duration::from_millis(5));
        }
        sweep.wait().unwrap();
    }
}

/// A scene file and its path are one scene: its rows and those of the other program share a figure, in either spelling.
#[test]
fn it_meets_our_own_rows_of_the_same_scene_file() {
    let scene = "about = \"A room\"\nbase = \"cornell\"\n";
    for spelling in ["room.toml", "./room.toml"] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("room.toml"), scene).unwrap();
        let (_, matrix) = TINY.split_once("[matrix]").unwrap();
        let own = matrix
            .replace("[\"cornell\"]", "[\"room.toml\"]")
            .replace("[\"serial\", \"static-blocks\", \"work-stealing\"]", "[\"serial\"]");
        assert!(own.contains("room.toml"), "{own}");
        let (own, scales) = own.split_once("[quick]").unwrap();
        let own = own.replace("seed = [1]", "seed = [3, 4]");
        let other = table(BLACK).replace("\"cornell\"", &format!("\"{spelling}\""));
        let scales = scales.replacen("repetitions = 3", "repetitions = 1\nreference-spp = 40", 1);
        let head = TINY
            .split_once("[matrix]")
            .unwrap()
            .0
            .replace("[\"speedup\", \"schedules\"]", "[\"error-against-time\", \"pairs\"]");
        write_tiny(
            folder.path(),
            &format!("{head}[matrix]{own}[reference]\nestimator = \"bsdf\"\n\n{other}\n[quick]{scales}"),
        );
        finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
        let halves = std::fs::read_dir(folder.path().join("out/references")).unwrap().count();
        let pairs = std::fs::read_to_string(folder.path().join("out/tiny/figures/pairs.csv")).unwrap_or_default();
        assert!(pairs.contains("other"), "{spelling}: {pairs}");
        assert_eq!(halves, 2, "one reference");
    }
}
