//! F02, F06, F11: real limits of the system, set on the program from outside.

use super::{is_thorough, skip, sweep};
use crate::experiment::write_tiny;
use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use pathmark::measure::OUTPUTS;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const RENDER: [&str; 6] = ["render", "cornell", "--size", "16x12", "--spp", "4"];

/// Runs `pathmark ARGUMENTS` under a limit of `prlimit`; `None` if there is no such program.
fn limited(folder: &Path, limit: &str, arguments: &[impl AsRef<OsStr>]) -> Option<Finished> {
    limited_command(folder, limit, arguments).map(finish)
}

fn limited_command(folder: &Path, limit: &str, arguments: &[impl AsRef<OsStr>]) -> Option<Command> {
    if Command::new("prlimit").arg("--version").output().is_err() {
        skip("there is no program prlimit");
        return None;
    }
    let inner = pathmark(folder, arguments);
    // A write beyond the limit sends a signal; if that is ignored, the write fails as on a full disk.
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' XFSZ; exec prlimit \"$@\"", "sh", limit]).arg(inner.get_program());
    command.args(inner.get_args()).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    Some(command)
}

/// The system limits the size of a file: real short writes, at several lengths.
#[test]
fn a_file_that_may_not_grow_leaves_the_old_one() {
    let _watchdog = Watchdog::new(Duration::from_mins(3));
    let folder = tempfile::tempdir().unwrap();
    for format in ["ppm", "exr"] {
        let name = format!("image.{format}");
        let arguments = [&RENDER[..], &["-o", &name]].concat();
        finish(pathmark(folder.path(), &arguments)).with_code(0);
        let whole = fs::read(folder.path().join(&name)).unwrap();
        fs::write(folder.path().join(&name), "old").unwrap();
        for length in [0, 1, whole.len() / 2, whole.len() - 1] {
            let Some(finished) = limited(folder.path(), &format!("--fsize={length}"), &arguments) else { return };
            let finished = finished.with_code(3);
            assert!(finished.err.contains(&format!("writing {name}: ")), "{}", finished.err);
            assert_eq!(fs::read(folder.path().join(&name)).unwrap(), b"old", "{length} bytes");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "{length} bytes");
        }
        let limit = format!("--fsize={}", whole.len());
        limited(folder.path(), &limit, &arguments).unwrap().with_code(0);
        assert_eq!(fs::read(folder.path().join(&name)).unwrap(), whole);
        fs::remove_file(folder.path().join(&name)).unwrap();
    }
}

/// A small file system, unmounted when this is dropped.
struct Mounted<'a>(&'a Path);

impl<'a> Mounted<'a> {
    fn new(folder: &'a Path, size: &str) -> Option<Self> {
        let options = format!("size={size}");
        let mount = Command::new("mount").args(["-t", "tmpfs", "-o", &options, "tmpfs"]).arg(folder).output();
        if mount.is_ok_and(|done| done.status.success()) {
            return Some(Self(folder));
        }
        skip("a small tmpfs cannot be mounted here; the injected disk tries the same");
        None
    }

    fn resize(&self, size: &str) {
        let options = format!("remount,size={size}");
        assert!(Command::new("mount").args(["-o", &options]).arg(self.0).status().unwrap().success());
    }
}

impl Drop for Mounted<'_> {
    fn drop(&mut self) {
        Command::new("umount").arg(self.0).status().ok();
    }
}

/// A sweep onto a disk that is too small names the file that it could not write. With more space, it resumes to the
/// rows of a sweep that had enough from the start.
#[test]
fn a_sweep_onto_a_small_disk_goes_on_when_there_is_space() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let enough = tempfile::tempdir().unwrap();
    let resume = ["run", "tiny.toml", "--out", "out", "--resume"];
    write_tiny(enough.path(), &sweep::text());
    finish(pathmark(enough.path(), &resume)).with_code(0);
    let expected = (sorted_rows(enough.path()), sweep::pictures(enough.path()));
    for size in ["4k", "8k", "48k", "64k", "72k"] {
        watchdog.now(size);
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        fs::create_dir(&out).unwrap();
        let Some(disk) = Mounted::new(&out, size) else { return };
        write_tiny(folder.path(), &sweep::text());
        let full = finish(pathmark(folder.path(), &resume));
        let said = full.err.clone();
        if said.contains("No space left on device") {
            assert!(said.contains("out/"), "{size}: {said}");
            // A row that fails for lack of space is written as a failed row, unless that finds no space either.
            if said.contains("rows failed") {
                full.with_code(1)
            } else {
                full.with_code(3)
            };
        } else {
            // The length of rows depends on times and warnings, so a larger disk may have been large enough.
            full.with_code(0);
            assert!(size != "4k", "{said}");
        }
        disk.resize("16m");
        finish(pathmark(folder.path(), &resume)).with_code(0);
        let found = (sorted_rows(folder.path()), sweep::pictures(folder.path()));
        assert!(found.0 == expected.0, "{size}: other rows");
        assert!(found.1 == expected.1, "{size}: another image");
    }
}

/// The rows in a fixed order: failed rows are run again, so they may be at another place.
fn sorted_rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let mut rows = sweep::rows(folder);
    for row in &mut rows {
        row.remove("run_order");
    }
    rows.sort_by_key(|row| (row["cell"].clone(), row["repetition"].clone()));
    rows
}

/// A film too large for the memory is refused before anything is rendered, with every output method.
#[test]
fn a_film_too_large_is_refused_before_the_work() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    for output in OUTPUTS.iter().map(|entry| entry.name) {
        // This render would take days.
        let large = ["render", "cornell", "--size", "8192x8192", "--spp", "400000", "--output", output, "-o", "a.pfm"];
        let Some(finished) = limited(folder.path(), "--as=3000000000", &large) else { return };
        let finished = finished.with_code(3);
        assert!(finished.err.contains("reserving memory for 8192x8192 pixels"), "{output}: {}", finished.err);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

/// The least address space, in bytes, in which `pathmark list` runs: enough to load the program, and little more.
fn least(folder: &Path) -> Option<u64> {
    let is_enough =
        |bytes: &u64| limited(folder, &format!("--as={bytes}"), &["list"]).is_some_and(|end| end.code == Some(0));
    limited(folder, "--as=1000000000000", &["list"])?;
    (1..2048).map(|k| k << 20).find(is_enough)
}

/// Runs `pathmark ARGUMENTS` under a memory limit. The command succeeds or names the refused resource; it never hangs.
/// Returns whether it succeeded.
fn done_or_refused(folder: &Path, bytes: u64, arguments: &[&str]) -> bool {
    let finished = limited(folder, &format!("--as={bytes}"), arguments).expect("`least` found prlimit");
    let is_done = finished.code == Some(0);
    let finished = finished.with_code(if is_done { 0 } else { 3 });
    let said = ["memory", "starting ", "Cannot allocate"].iter().any(|word| finished.err.contains(word));
    assert!(is_done || said, "{arguments:?} in {bytes} bytes: {}", finished.err);
    is_done
}

/// Every command in just enough memory to load the program, and in more, up to enough. The place of the refusal is
/// random.
#[test]
fn too_little_memory_is_the_systems_fault() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let Some(least) = least(folder.path()) else { return };
    let prepare = ["render", "cornell", "--size", "256x256", "--spp", "4", "-o", "a.exr", "--trace", "run.csv"];
    finish(pathmark(folder.path(), &prepare)).with_code(0);
    let commands: [&[&str]; 9] = [
        &["render", "cornell", "--size", "128x96", "--spp", "4", "-o", "b.png"],
        &["render", "cornell", "--size", "128x96", "--spp", "4", "-o", "b.exr", "--output", "channel-pixel"],
        &["render", "spheres:2000", "--size", "16x12", "--spp", "16", "-o", "b.pfm", "--checkpoint", "b.film"],
        &["render", "cornell", "--size", "2x64", "--spp", "4", "--strategy", "thread-per-row", "-o", "b.pfm"],
        &["image", "reference", "cornell", "--size", "64x48", "--spp", "16", "--out", "references"],
        &["image", "compare", "a.exr", "a.exr", "--heatmap", "b.png"],
        &["inspect", "bounces", "cornell", "--size", "16x12"],
        &["inspect", "jobs", "run.csv", "-o", "run.png"],
        &["selftest", "S11"],
    ];
    for arguments in commands {
        for more in [0, 1, 2, 3, 4, 6, 8, 11, 16, 23, 32, 64] {
            watchdog.now(format!("{arguments:?} in {more} MiB more than nothing"));
            if done_or_refused(folder.path(), least + (more << 20), arguments) {
                break;
            }
        }
    }
}

/// Memory for 16 million jobs is refused, but there is enough for a backtrace, which overwrites the error number of the
/// refusal.
#[test]
fn refused_memory_has_its_exit_code_also_with_a_backtrace() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let Some(least) = least(folder.path()) else { return };
    let many =
        ["render", "cornell", "--size", "4096x4096", "--spp", "4", "--decomposition", "tiles:1x1", "-o", "a.pfm"];
    // The order of the jobs takes 8 bytes a job. Their pieces, at 24 bytes a job, find less room than they need.
    let limit = format!("--as={}", least + (30 << 24));
    for backtrace in ["0", "1", "full"] {
        let Some(mut command) = limited_command(folder.path(), &limit, &many) else { return };
        command.env("RUST_BACKTRACE", backtrace);
        let finished = finish(command).with_code(3);
        assert!(finished.err.contains("the system refused memory"), "{backtrace}: {}", finished.err);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{backtrace}");
    }
}

/// Thread stacks are memory, too. At some limits, a new thread's small signal stack is refused.
#[test]
fn too_little_memory_for_threads_is_the_systems_fault() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let Some(least) = least(folder.path()) else { return };
    let arguments =
        ["render", "cornell", "--size", "2x64", "--spp", "4", "--strategy", "thread-per-row", "-o", "a.pfm"];
    // The limits cover the size of a stack, page by page in thorough runs.
    let step = if is_thorough() { 1 << 12 } else { 1 << 16 };
    for more in (0..2 << 20).step_by(step) {
        watchdog.now(format!("threads in {more} bytes more than nothing"));
        done_or_refused(folder.path(), least + (24 << 20) + more, &arguments);
    }
}
