//! F02, F06, F11: real limits of the system, set on the program from outside.

use super::{skip, sweep};
use crate::experiment::write_tiny;
use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const RENDER: [&str; 6] = ["render", "cornell", "--size", "16x12", "--spp", "4"];

/// `pathmark ARGUMENTS` with a limit of `prlimit` on it, or nothing if there is no such program.
fn limited(folder: &Path, limit: &str, arguments: &[impl AsRef<OsStr>]) -> Option<Finished> {
    if Command::new("prlimit").arg("--version").output().is_err() {
        skip("there is no program prlimit");
        return None;
    }
    let inner = pathmark(folder, arguments);
    // A write beyond the limit sends a signal; where that is ignored, the write fails as on a full disk.
    let mut command = Command::new("sh");
    command.args(["-c", "trap '' XFSZ; exec prlimit \"$@\"", "sh", limit]).arg(inner.get_program());
    command.args(inner.get_args()).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    Some(finish(command))
}

/// The system takes so many bytes of a file and no more: real short writes, at every length.
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

/// A small file system of its own; gone when this is dropped.
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

/// A sweep onto disks of many sizes, all of them too small, says which file it could not write. With more space it goes on to the rows
/// of one that had enough from the start.
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
        assert!(said.contains("out/") && said.contains("No space left on device"), "{size}: {said}");
        // Rows that failed for want of space are rows, unless they find none either.
        let full = if said.contains("rows failed") { full.with_code(1) } else { full.with_code(3) };
        assert!(!full.err.contains("panicked"));
        disk.resize("16m");
        finish(pathmark(folder.path(), &resume)).with_code(0);
        let found = (sorted_rows(folder.path()), sweep::pictures(folder.path()));
        assert!(found.0 == expected.0, "{size}: other rows");
        assert!(found.1 == expected.1, "{size}: another image");
    }
}

/// Rows that failed are run again, and so may stand at another place.
fn sorted_rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let mut rows = sweep::rows(folder);
    for row in &mut rows {
        row.remove("order");
    }
    rows.sort_by_key(|row| (row["cell"].clone(), row["repetition"].clone()));
    rows
}

/// Memory that the system does not give: an error that says so, or an image; never a hang or a silent end.
#[test]
fn too_little_memory_is_the_systems_fault() {
    let watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let large = ["render", "cornell", "--size", "8192x8192", "--spp", "4", "-o", "image.pfm"];
    let Some(finished) = limited(folder.path(), "--as=1000000000", &large) else { return };
    let finished = finished.with_code(3);
    assert!(finished.err.contains("memory"), "{}", finished.err);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);

    // Threads' stacks are memory too: 768 of them, 2 MiB each.
    let tall = ["render", "cornell", "--size", "2x768", "--spp", "4", "-o", "image.pfm"];
    finish(pathmark(folder.path(), &tall)).with_code(0);
    let expected = fs::read(folder.path().join("image.pfm")).unwrap();
    for limit in [300, 600, 1000] {
        watchdog.now(format!("threads in {limit} MB"));
        fs::remove_file(folder.path().join("image.pfm")).unwrap();
        let arguments = [&tall[..], &["--strategy", "thread-per-row"]].concat();
        let finished = limited(folder.path(), &format!("--as={limit}000000"), &arguments).unwrap();
        if finished.err.is_empty() || folder.path().join("image.pfm").exists() {
            finished.with_code(0);
            assert_eq!(fs::read(folder.path().join("image.pfm")).unwrap(), expected);
        } else {
            let finished = finished.with_code(3);
            assert!(finished.err.contains("worker") && finished.err.contains(" of 768"), "{}", finished.err);
            finish(pathmark(folder.path(), &tall)).with_code(0);
        }
    }
}
