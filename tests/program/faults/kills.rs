//! F01: a checkpointed render that a signal ends at any instant resumes to the image of an undisturbed render, bit for
//! bit.

use super::{is_thorough, skip};
use crate::program::{finish, pathmark};
use crate::watchdog::Watchdog;
use nix::sys::signal::{Signal, kill, killpg};
use nix::unistd::Pid;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fs::{self, File};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// A way to end a program: a signal from the system or a batch queue, or ^C, which reaches every process of the group.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Ending {
    /// The signal goes to one process.
    One(Signal),
    /// The signal goes to all processes of the group.
    Group(Signal),
}

const ENDINGS: [Ending; 3] =
    [Ending::One(Signal::SIGKILL), Ending::One(Signal::SIGTERM), Ending::Group(Signal::SIGINT)];

/// The endings that work here. Children inherit ignored signals, and shells let background jobs ignore some.
pub(crate) fn endings() -> Vec<Ending> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    let works = |ending: &Ending| {
        let (Ending::One(signal) | Ending::Group(signal)) = *ending;
        let works = ignored & 1 << (signal as i32 - 1) == 0;
        if !works {
            skip(&format!("{signal} is ignored here, as in the background of a shell"));
        }
        works
    };
    ENDINGS.into_iter().filter(works).collect()
}

/// Ends programs at random instants, the same ones in every run of the test.
pub(crate) struct Killer<'a> {
    folder: &'a Path,
    random: Pcg64,
    /// Duration of an undisturbed run.
    whole: Duration,
    watchdog: Watchdog,
}

/// The end of a run that was to be killed.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum End {
    Killed,
    Finished,
}

impl<'a> Killer<'a> {
    pub(crate) fn new(folder: &'a Path, whole: Duration) -> Self {
        Self { folder, random: Pcg64::seed_from_u64(1), whole, watchdog: Watchdog::new(Duration::from_mins(2)) }
    }

    /// Kills required for each ending.
    pub(crate) fn kills() -> usize {
        if is_thorough() { 200 } else { 4 }
    }

    /// Starts the program and ends it at a random instant, unless it finishes first. `is_new`: it has nothing to resume
    /// from.
    pub(crate) fn run(&mut self, mut command: Command, ending: Ending, is_new: bool) -> End {
        let instant = self.random.random_range(0.0..1.1) * self.whole.as_secs_f64();
        self.watchdog.now(format!("after {ending:?} at {instant} s"));
        // To files: nobody reads while the program runs, and a full pipe would block it.
        let said = self.folder.join("said.txt");
        command.process_group(0).stdout(Stdio::null()).stderr(File::create(&said).unwrap());
        let start = Instant::now();
        let mut child = command.spawn().unwrap();
        while start.elapsed().as_secs_f64() < instant && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        if is_new && child.try_wait().unwrap().is_some() {
            // The machine is less busy than before, so later kills would come too late.
            self.whole = self.whole.min(start.elapsed());
        }
        let id = Pid::from_raw(child.id().try_into().unwrap());
        // An ended process has been waited for, and its id may belong to another process by now.
        if child.try_wait().unwrap().is_none() {
            match ending {
                Ending::One(signal) => kill(id, signal).unwrap(),
                Ending::Group(signal) => killpg(id, signal).unwrap(),
            }
        }
        let status = child.wait().unwrap();
        let said = fs::read_to_string(&said).unwrap();
        assert!(!said.contains("panicked"), "{said}");
        match status.code() {
            None => End::Killed,
            Some(0) => End::Finished,
            Some(code) => panic!("{ending:?} at {instant} s: exit code {code}: {said}"),
        }
    }
}

/// The number of files that killed processes left unfinished and later processes did not remove.
pub(crate) fn leftovers(folder: &Path) -> usize {
    let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.starts_with(".pathmark-") && name.rsplit_once('.').is_some_and(|(_, end)| end == "tmp"))
        .count()
}

const RENDER: [&str; 14] = [
    "render",
    "cornell",
    "--size",
    "40x30",
    "--spp",
    "720",
    "--estimator",
    "mis",
    "--threads",
    "2",
    "--checkpoint",
    "render.checkpoint",
    "-o",
    "image.exr",
];

/// Runs the program until it is not killed. Returns the number of kills, and how many of them left `file` to resume
/// from.
fn in_spite_of_kills(killer: &mut Killer<'_>, ending: Ending, arguments: &[&str], file: &Path) -> (usize, usize) {
    let (mut kills, mut resumed) = (0, 0);
    while killer.run(pathmark(killer.folder, arguments), ending, !file.exists()) == End::Killed {
        kills += 1;
        resumed += usize::from(file.exists());
    }
    (kills, resumed)
}

#[test]
fn a_checkpointed_render_killed_at_any_instant_comes_to_the_same_image() {
    let folder = tempfile::tempdir().unwrap();
    let (checkpoint, image) = (folder.path().join("render.checkpoint"), folder.path().join("image.exr"));
    let start = Instant::now();
    finish(pathmark(folder.path(), &RENDER)).with_code(0);
    let whole = start.elapsed();
    let expected = fs::read(&image).unwrap();
    let mut killer = Killer::new(folder.path(), whole);
    for ending in endings() {
        let (mut kills, mut renders, mut resumed) = (0, 0, 0);
        // Kills come at random instants, so the loop continues until one has left a checkpoint.
        while kills < Killer::kills() || resumed == 0 {
            fs::remove_file(&checkpoint).ok();
            fs::remove_file(&image).ok();
            let (more, of_them) = in_spite_of_kills(&mut killer, ending, &RENDER, &checkpoint);
            assert!(fs::read(&image).unwrap() == expected, "{ending:?}: another image after {more} kills");
            (kills, resumed, renders) = (kills + more, resumed + of_them, renders + 1);
        }
        println!(
            "{ending:?}: {kills} kills, {resumed} with a checkpoint to go on from, {renders} renders to their end"
        );
    }
    println!("whole render {whole:?}");
    assert_eq!(leftovers(folder.path()), 0, "unfinished files that kills left");
}

/// The same for parts of an image: merged, they have the bits of an undisturbed image.
#[test]
fn parts_killed_at_any_instant_come_to_the_same_image() {
    let folder = tempfile::tempdir().unwrap();
    let start = Instant::now();
    finish(pathmark(folder.path(), &RENDER)).with_code(0);
    let mut killer = Killer::new(folder.path(), start.elapsed() / 2);
    let expected = fs::read(folder.path().join("image.exr")).unwrap();
    let common = &RENDER[..10];
    let (mut kills, mut resumed) = (0, 0);
    while kills < Killer::kills() || resumed == 0 {
        for by in ["samples", "tiles"] {
            let shards = ["1/2", "2/2"].map(|shard| (shard, format!("{}.film", &shard[..1])));
            for (shard, name) in &shards {
                let arguments = [common, &["--shard", shard, "--shard-by", by, "-o", name]].concat();
                let file = folder.path().join(name);
                fs::remove_file(&file).ok();
                let (more, of_them) = in_spite_of_kills(&mut killer, Ending::One(Signal::SIGKILL), &arguments, &file);
                (kills, resumed) = (kills + more, resumed + of_them);
            }
            let merge = ["merge", "1.film", "2.film", "-o", "merged.exr"];
            finish(pathmark(folder.path(), &merge)).with_code(0);
            assert!(fs::read(folder.path().join("merged.exr")).unwrap() == expected, "{by}, after {kills} kills");
        }
    }
    println!("{kills} kills of parts, {resumed} with a file to go on from");
    assert_eq!(leftovers(folder.path()), 0, "unfinished files that kills left");
}
