//! F11: threads that the system refuses. Commands that need them say so, with exit code 3 and no output written; all
//! others work.

use super::skip;
use crate::program::{Finished, finish, pathmark};
use crate::watchdog::Watchdog;
use pathmark::strategy::STRATEGIES;
use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// A user with no rights and no other processes. The limit counts a user's threads, and does not apply to root.
const NOBODY: u32 = 65534;

/// The program in a folder where every user may run it and write.
struct Public(TempDir);

impl Public {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("pathmark");
        fs::copy(pathmark(folder.path(), &["list"]).get_program(), &copy).unwrap();
        fs::set_permissions(folder.path(), Permissions::from_mode(0o777)).unwrap();
        Self(folder)
    }

    fn folder(&self) -> &Path {
        self.0.path()
    }

    /// Runs `pathmark ARGUMENTS` as a user who may have at most `threads` threads.
    fn limited(&self, threads: usize, arguments: &[&str]) -> Finished {
        let mut command = Command::new("prlimit");
        command.arg(format!("--nproc={threads}")).arg("./pathmark").args(arguments).current_dir(self.folder());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        if fs::metadata(self.folder()).unwrap().uid() == 0 {
            command.uid(NOBODY).gid(NOBODY);
        }
        finish(command)
    }

    /// Whether the system limits threads here: not without `prlimit`, and not in every container.
    fn is_limited(&self) -> bool {
        if Command::new("prlimit").arg("--version").output().is_err() {
            skip("there is no program prlimit");
            return false;
        }
        let refused = self.limited(1, &[&RENDER[..], &["--quiet", "-o", "none.pfm"]].concat());
        let is_limited = !refused.err.is_empty();
        if !is_limited {
            skip("the system gives threads beyond the limit");
        }
        is_limited
    }

    fn files(&self) -> usize {
        fs::read_dir(self.folder()).unwrap().count()
    }
}

/// Four pieces, three workers.
const RENDER: [&str; 10] =
    ["render", "cornell", "--size", "16x12", "--spp", "4", "--threads", "3", "--decomposition", "tiles:8x8"];
/// Enough for every strategy: the main thread, the progress thread, a worker for each piece, and threads of libraries.
const ENOUGH: usize = 10;

/// Under any strategy, a render with too few threads names the thread that could not be started; with enough, it gives
/// the image.
#[test]
fn a_render_has_all_its_threads_or_is_refused() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let public = Public::new();
    if !public.is_limited() {
        return;
    }
    finish(pathmark(public.folder(), &[&RENDER[..], &["-o", "right.pfm"]].concat())).with_code(0);
    let right = fs::read(public.folder().join("right.pfm")).unwrap();
    let files = public.files();
    for name in STRATEGIES.iter().map(|entry| entry.name) {
        let mut whole = 0;
        for threads in 1..=ENOUGH {
            watchdog.now(format!("{name}, {threads} threads"));
            let finished = public.limited(threads, &[&RENDER[..], &["--strategy", name, "-o", "a.pfm"]].concat());
            if let Ok(image) = fs::read(public.folder().join("a.pfm")) {
                finished.with_code(0);
                assert!(image == right, "{name}, {threads} threads");
                fs::remove_file(public.folder().join("a.pfm")).unwrap();
                whole += 1;
            } else {
                let finished = finished.with_code(3);
                assert!(finished.err.contains("starting "), "{name}, {threads} threads: {}", finished.err);
            }
            assert_eq!(public.files(), files, "{name}, {threads} threads");
        }
        assert!((1..ENOUGH).contains(&whole), "{name}: {whole} of {ENOUGH} limits leave all threads");
    }
}

/// Other commands with a single thread.
#[test]
fn commands_that_need_threads_say_so_and_the_others_go_on() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let public = Public::new();
    if !public.is_limited() {
        return;
    }
    let trace = [&RENDER[..], &["-o", "a.pfm", "--trace", "run.csv"]].concat();
    finish(pathmark(public.folder(), &trace)).with_code(0);
    let files = public.files();
    let refused: [&[&str]; 5] = [
        &["selftest", "S11", "P01"],
        &["image", "reference", "cornell", "--size", "16x12", "--spp", "16", "--out", "."],
        &["price", "cornell", "--size", "16x12", "--rmse", "0.1"],
        &["simulate", "run.csv", "--out", "."],
        &["render", "cornell", "--size", "16x12", "--spp", "64", "--adaptive", "-o", "b.pfm"],
    ];
    for arguments in refused {
        watchdog.now(arguments.join(" "));
        let finished = public.limited(1, arguments).with_code(3);
        assert!(finished.err.contains("starting "), "{arguments:?}: {}", finished.err);
        assert_eq!(public.files(), files, "{arguments:?}");
    }
    let fine: [&[&str]; 5] = [
        &["list"],
        &["inspect", "jobs", "run.csv"],
        &["image", "compare", "a.pfm", "a.pfm"],
        &["inspect", "bounces", "cornell", "--size", "16x12"],
        &["inspect", "path", "cornell", "--size", "16x12", "--pixel", "3,4"],
    ];
    for arguments in fine {
        watchdog.now(arguments.join(" "));
        public.limited(1, arguments).with_code(0);
    }
}
