//! F03: one file, one writer. A second process is told so, and the first goes on.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use crate::watchdog::Watchdog;
use pathmark::lock::{Lock, try_lock};
use std::fs::{self, File};
use std::path::Path;
use std::process::Child;
use std::time::Duration;

const LONG: [&str; 10] =
    ["render", "cornell", "--size", "64x48", "--spp", "4000000", "--checkpoint", "render.checkpoint", "-o", "a.pfm"];

/// Starts a program that would run for hours, and waits for a file that it makes.
fn running(folder: &Path, arguments: &[&str], file: &str) -> Child {
    let child = pathmark(folder, arguments).spawn().unwrap();
    while !folder.join(file).exists() {
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

fn end(mut child: Child) {
    assert!(child.try_wait().unwrap().is_none(), "the first process has not gone on");
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn two_renders_do_not_share_a_checkpoint() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let first = running(folder.path(), &LONG, "render.checkpoint");
    std::os::unix::fs::symlink("render.checkpoint", folder.path().join("another-name")).unwrap();
    for name in ["render.checkpoint", "another-name"] {
        let arguments = LONG.map(|word| match word {
            "render.checkpoint" => name,
            "a.pfm" => "b.pfm",
            word => word,
        });
        let second = finish(pathmark(folder.path(), &arguments)).with_code(2);
        let said = format!("checkpoint = {name}: is being written by another process");
        assert!(second.err.contains(&said), "{}", second.err);
        assert!(!folder.path().join("b.pfm").exists());
    }
    end(first);
    // A lock file that a killed process left locks nothing, and goes with the next one that ends by itself.
    assert!(folder.path().join("render.checkpoint.lock").exists());
    fs::remove_file(folder.path().join("render.checkpoint")).unwrap();
    let short = LONG.map(|word| if word == "4000000" { "16" } else { word });
    finish(pathmark(folder.path(), &short)).with_code(0);
    assert!(!folder.path().join("render.checkpoint.lock").exists());
}

#[test]
fn two_processes_do_not_render_into_one_folder_of_references() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let reference = |spp| ["reference", "cornell", "--size", "64x48", "--out", "references", "--spp", spp];
    let first = running(folder.path(), &reference("4000000"), "references/.lock");
    let second = finish(pathmark(folder.path(), &reference("40"))).with_code(2);
    assert!(second.err.contains("references = references: is being written by another process"), "{}", second.err);
    // So does a sweep that needs one.
    let text = TINY.replace("[quick]\n", "[reference]\nestimator = \"bsdf\"\n\n[quick]\nreference-spp = 40\n");
    write_tiny(folder.path(), &text);
    let sweep = finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "."])).with_code(2);
    assert!(sweep.err.contains("is being written by another process"), "{}", sweep.err);
    end(first);
    finish(pathmark(folder.path(), &reference("40"))).with_code(0);
    assert!(!folder.path().join("references/.lock").exists());
    // What is there is only read, and may be on a disk that is only read: no lock is asked for.
    let held = Lock::new(&folder.path().join("references/.lock"), "references", folder.path()).unwrap();
    finish(pathmark(folder.path(), &reference("40"))).with_code(0);
    drop(held);
}

#[test]
fn a_lock_is_taken_by_one_at_a_time() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lock");
    let take = || Lock::new(&path, "field", Path::new("what"));
    let first = take().unwrap();
    let error = take().unwrap_err();
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().starts_with("field = what: is being written by another process"), "{error}");
    drop(first);
    // Many want it at once: never do two have it, and each that waits no longer than its patience may get it.
    let inside = std::sync::atomic::AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for _ in 0..20 {
                    let Ok(lock) = take() else { continue };
                    assert_eq!(inside.fetch_add(1, std::sync::atomic::Ordering::SeqCst), 0);
                    std::thread::sleep(Duration::from_millis(1));
                    inside.fetch_sub(1, std::sync::atomic::Ordering::SeqCst);
                    drop(lock);
                }
            });
        }
    });
    assert!(!path.exists());
}

/// Who waited for a file that was removed meanwhile has locked nothing: the next one makes a file of that name and locks that.
#[test]
fn the_lock_of_a_removed_file_is_none() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lock");
    let [held, waited_for] = [(); 2].map(|()| File::create(&path).unwrap());
    held.lock().unwrap();
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| try_lock(&waited_for, &path).unwrap());
        // Long enough for it to find the lock held, and shorter than its patience.
        std::thread::sleep(Duration::from_millis(300));
        fs::remove_file(&path).unwrap();
        drop(held);
        assert!(!waiting.join().unwrap());
    });
}
