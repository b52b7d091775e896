//! F03: one file, one writer. A second process is refused, and the first continues.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark, wait};
use crate::watchdog::Watchdog;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use pathmark::lock::{Lock, Sharing, try_lock};
use std::fs::{self, File};
use std::path::Path;
use std::process::Child;
use std::time::Duration;

const LONG: [&str; 10] =
    ["render", "cornell", "--size", "64x48", "--spp", "4000000", "--checkpoint", "render.checkpoint", "-o", "a.pfm"];

/// Starts a program that would run for hours, and stops it as soon as a file is as wanted: it keeps its locks, and
/// computes nothing meanwhile.
fn running(folder: &Path, arguments: &[&str], file: &str, is_as_wanted: impl Fn(&Path) -> bool) -> Child {
    let child = pathmark(folder, arguments).spawn().unwrap();
    while !is_as_wanted(&folder.join(file)) {
        std::thread::sleep(Duration::from_millis(5));
    }
    signal(&child, Signal::SIGSTOP);
    child
}

fn is_locked(path: &Path) -> bool {
    File::open(path).is_ok_and(|file| file.try_lock_shared().is_err())
}

fn signal(child: &Child, signal: Signal) {
    kill(Pid::from_raw(child.id().try_into().unwrap()), signal).unwrap();
}

/// Commands are refused, each because this file is being written. They run at once, since each of them waits a second
/// for the lock.
fn are_refused(folder: &Path, commands: &[(&[&str], &str)]) {
    let waiting: Vec<Child> =
        commands.iter().map(|(arguments, _)| pathmark(folder, arguments).spawn().unwrap()).collect();
    for (child, (arguments, file)) in waiting.into_iter().zip(commands) {
        let refused = wait(child).with_code(2);
        let said = format!("{file}: is being written by another process");
        assert!(refused.err.contains(&said), "{arguments:?}: {}", refused.err);
    }
}

/// The number of Pathmark's lock files in a folder.
fn lock_files(folder: &Path) -> usize {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.starts_with(".pathmark") && name.rsplit_once('.').is_some_and(|(_, end)| end == "lock"))
        .count()
}

fn end(mut child: Child) {
    signal(&child, Signal::SIGCONT);
    assert!(child.try_wait().unwrap().is_none(), "the first process has not gone on");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn two_renders_do_not_share_a_checkpoint() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let first = running(folder.path(), &LONG, "render.checkpoint", Path::exists);
    std::os::unix::fs::symlink("render.checkpoint", folder.path().join("another-name")).unwrap();
    let second = LONG.map(|word| if word == "a.pfm" { "b.pfm" } else { word });
    let linked = second.map(|word| if word == "render.checkpoint" { "another-name" } else { word });
    let [own, other] = ["checkpoint = render.checkpoint", "checkpoint = another-name"];
    are_refused(folder.path(), &[(&second, own), (&linked, other)]);
    assert!(!folder.path().join("b.pfm").exists());
    end(first);
    // A lock file of a killed process locks nothing, and the next process that ends by itself removes it. No file of
    // the user has such a name.
    assert_eq!(lock_files(folder.path()), 1);
    fs::remove_file(folder.path().join("render.checkpoint")).unwrap();
    fs::write(folder.path().join("render.checkpoint.lock"), "the user's").unwrap();
    let short = LONG.map(|word| if word == "4000000" { "16" } else { word });
    finish(pathmark(folder.path(), &short)).with_code(0);
    assert_eq!(lock_files(folder.path()), 0);
    assert_eq!(fs::read(folder.path().join("render.checkpoint.lock")).unwrap(), b"the user's");
}

#[test]
fn two_processes_do_not_render_into_one_folder_of_references() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let reference = |spp| ["image", "reference", "cornell", "--size", "64x48", "--out", "references", "--spp", spp];
    fs::create_dir(folder.path().join("references")).unwrap();
    fs::write(folder.path().join("references/.lock"), "the user's").unwrap();
    let first = running(folder.path(), &reference("4000000"), "references/.pathmark.lock", is_locked);
    // A sweep that needs a reference is refused, too.
    let text = TINY.replace("[quick]\n", "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n");
    write_tiny(folder.path(), &text);
    let sweep = ["run", "tiny.toml", "--out", "."];
    are_refused(folder.path(), &[(&reference("40"), "references = references"), (&sweep, "references")]);
    end(first);
    finish(pathmark(folder.path(), &reference("40"))).with_code(0);
    assert_eq!(lock_files(&folder.path().join("references")), 0);
    assert_eq!(fs::read(folder.path().join("references/.lock")).unwrap(), b"the user's");
    // Existing references are only read, perhaps from a read-only disk, so no lock is taken.
    let held = Lock::of_folder(&folder.path().join("references"), "references", Sharing::Alone).unwrap();
    finish(pathmark(folder.path(), &reference("40"))).with_code(0);
    drop(held);
}

/// `reproduce` has the folder to itself from its first look at an earlier run's files until the page is written; other
/// commands share it.
#[test]
fn reproduce_shares_its_folder_with_nobody() {
    let _watchdog = Watchdog::new(Duration::from_mins(5));
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), TINY);
    let out = folder.path().join("out");
    let run = ["run", "tiny.toml", "--out", "out"];
    let reproduce = ["reproduce", "--out", "out"];
    let first = running(folder.path(), &reproduce, "out/.pathmark.lock", is_locked);
    let elsewhere = ["reproduce", "--out", "./out/.", "--resume"];
    let selftest = ["selftest", "--out", "out"];
    let all: [(&[&str], &str); 4] =
        [(&reproduce, "out = out"), (&elsewhere, "out = ./out/."), (&run, "out = out"), (&selftest, "out = out")];
    are_refused(folder.path(), &all);
    assert!(!out.join("earlier").exists());
    end(first);
    // An empty folder that another process shares to run an experiment.
    fs::remove_dir_all(&out).unwrap();
    fs::create_dir(&out).unwrap();
    let other = Lock::of_folder(&out, "out", Sharing::Shared).unwrap();
    finish(pathmark(folder.path(), &run)).with_code(0);
    are_refused(folder.path(), &[(&reproduce, "out = out")]);
    assert!(out.join("tiny/records.csv").exists() && !out.join("earlier").exists());
    drop(other);
    assert_eq!(lock_files(&out), 0);
    // Bursts of an earlier run are kept.
    fs::create_dir(out.join("bursts")).unwrap();
    fs::write(out.join("bursts/bursts.csv"), "rows").unwrap();
    // So are the verdicts of a replication, with what was measured a second time.
    let verdicts = r#"{"theirs":"t","share":0.1,"joint_level":0.95,"level":0.95,"machines":[],"statements":[]}"#;
    fs::write(out.join("replication.json"), verdicts).unwrap();
    fs::write(out.join("REPLICATION.md"), "# Replication of t").unwrap();
    fs::create_dir(out.join("again")).unwrap();
    end(running(folder.path(), &reproduce, "out/again", |path| !path.exists()));
    let earlier = fs::read_dir(out.join("earlier")).unwrap().next().unwrap().unwrap().path();
    assert_eq!(fs::read(earlier.join("bursts/bursts.csv")).unwrap(), b"rows");
    for name in ["replication.json", "REPLICATION.md"] {
        assert!(earlier.join(name).is_file() && !out.join(name).exists(), "{name}");
    }
}

#[test]
fn a_lock_is_taken_by_one_at_a_time_or_shared() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    // At once, since each refusal comes after a second.
    std::thread::scope(|scope| {
        for (held, wanted) in
            [(Sharing::Alone, Sharing::Alone), (Sharing::Alone, Sharing::Shared), (Sharing::Shared, Sharing::Alone)]
        {
            scope.spawn(move || {
                let folder = tempfile::tempdir().unwrap();
                let _first = Lock::of_folder(folder.path(), "field", held).unwrap();
                let error = Lock::of_folder(folder.path(), "field", wanted).unwrap_err();
                assert_eq!(error.exit_code(), 2);
                let said = format!("field = {}: is being written by another process", folder.path().display());
                assert!(error.to_string().starts_with(&said), "{error}");
            });
        }
    });
    let folder = tempfile::tempdir().unwrap();
    let take = |sharing| Lock::of_folder(folder.path(), "field", sharing);
    // Holders of a shared lock release it in any order; the last one removes the file.
    let [first, second] = [(); 2].map(|()| take(Sharing::Shared).unwrap());
    drop(first);
    assert_eq!(lock_files(folder.path()), 1);
    assert!(take(Sharing::Alone).is_err());
    drop(second);
    assert_eq!(lock_files(folder.path()), 0);
    // Many threads want the lock at once: never two have it, and a thread that waits within its patience may get it.
    let inside = std::sync::atomic::AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..8 {
                    let Ok(lock) = take(Sharing::Alone) else { continue };
                    assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                    std::thread::sleep(Duration::from_millis(1));
                    inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                    drop(lock);
                }
            });
        }
    });
    assert_eq!(lock_files(folder.path()), 0);
}

/// A file of the user that has a lock file's name is neither locked nor removed.
#[test]
fn a_file_that_is_no_lock_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(".pathmark.lock");
    fs::write(&path, "the user's").unwrap();
    let error = Lock::of_folder(folder.path(), "field", Sharing::Alone).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("is not a lock file"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), b"the user's");
}

/// A process that waited for a file removed meanwhile has locked nothing: the next process creates a new file of that
/// name and locks it.
#[test]
fn the_lock_of_a_removed_file_is_none() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lock");
    let [held, waited_for] = [(); 2].map(|()| File::create(&path).unwrap());
    held.lock().unwrap();
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| try_lock(&waited_for, &path, Sharing::Alone).unwrap());
        // Long enough to find the lock held, and shorter than the patience.
        std::thread::sleep(Duration::from_millis(300));
        fs::remove_file(&path).unwrap();
        drop(held);
        assert!(!waiting.join().unwrap());
    });
}
