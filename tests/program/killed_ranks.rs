//! Ranks of one image of which one is killed: all end, and other ranks resume their work.

use crate::faults::is_thorough;
use crate::program::{Finished, finish, pathmark, wait};
use crate::ranks::{RULES, has_launcher, is_launcher, json, launcher, launcher_named, program};
use crate::watchdog::Watchdog;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The ids of the processes that run `program` below a launcher.
fn processes_of(program: &Path, launcher: u32) -> Vec<u32> {
    let is_below = |mut pid: u32| loop {
        let Ok(stat) = fs::read_to_string(format!("/proc/{pid}/stat")) else { return false };
        let parent = stat.rsplit_once(')').and_then(|(_, rest)| rest.split_whitespace().nth(1)?.parse().ok());
        match parent {
            Some(parent) if parent == launcher => return true,
            Some(parent) if parent > 1 => pid = parent,
            _ => return false,
        }
    };
    let all = fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    all.filter(|pid| runs(program, *pid)).filter(|pid| is_below(*pid)).collect()
}

fn runs(program: &Path, pid: u32) -> bool {
    fs::read_link(format!("/proc/{pid}/exe")).is_ok_and(|exe| exe == program)
}

/// How long a launcher may take to end after all its processes have.
const LAUNCHERS_PATIENCE: Duration = Duration::from_secs(3);

/// Kills one of a launcher's ranks, if all ranks have started and it still runs after the delay `after`. When one rank
/// is gone, all end. After that, the launcher of Open MPI 4.1.4 sometimes waits for its own lock for ever, so it is
/// killed, too. A run that ends by itself must succeed.
fn with_a_rank_killed(mut command: Command, count: usize, after: Duration, victim: usize) -> Finished {
    let program = fs::canonicalize(program()).unwrap();
    let mut child = command.spawn().unwrap();
    let found = loop {
        let found = processes_of(&program, child.id());
        if found.len() == count || child.try_wait().unwrap().is_some() {
            break found;
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    std::thread::sleep(after);
    let victim = found.get(victim).filter(|pid| runs(&program, **pid));
    // The process may have ended meanwhile.
    let kill = |pid: &u32| Command::new("kill").args(["-9", &pid.to_string()]).stderr(Stdio::null()).status().unwrap();
    let is_killed = victim.is_some_and(|pid| kill(pid).success());
    while found.iter().any(|pid| runs(&program, *pid)) {
        std::thread::sleep(Duration::from_millis(5));
    }
    let gone = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if gone.elapsed() > LAUNCHERS_PATIENCE {
            let _ = child.kill();
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let finished = wait(child);
    assert!(is_killed || finished.code == Some(0), "{:?}: {}", finished.code, finished.err);
    finished
}

/// A rank that dies (SIGKILL) ends all ranks, with an error and without an image.
#[test]
fn a_rank_that_dies_ends_the_run() {
    if !has_launcher() {
        return;
    }
    let watchdog = Watchdog::new(Duration::from_secs(30));
    let folder = tempfile::tempdir().unwrap();
    for (victim, rule) in ["dynamic:1", "working-master:1", "static-cyclic"].into_iter().enumerate() {
        watchdog.now(format!("{rule}, rank {victim}"));
        let mut command = launcher(folder.path());
        let long = ["render", "cornell", "--spp", "20000", "--size", "64x48", "--threads", "1", "-o", "a.png"];
        command.args(["-n", "3"]).arg(program()).args(long).args(["--ranks", rule]);
        let finished = with_a_rank_killed(command, 3, Duration::from_millis(100 * victim as u64), victim);
        assert_ne!(finished.code, Some(0), "{rule}");
        assert!(!folder.path().join("a.png").exists());
    }
}

/// A render by ranks resumes from the checkpoint that it left when one of them was killed. With other ranks, another
/// rule and another library, it gives the image of one undisturbed process.
#[test]
fn ranks_continue_the_render_of_killed_ranks() {
    if !has_launcher() {
        return;
    }
    let watchdog = Watchdog::new(Duration::from_secs(30));
    let folder = tempfile::tempdir().unwrap();
    let render = ["render", "cornell", "--size", "40x30", "--spp", "1000", "--threads", "1", "--json"];
    let start = Instant::now();
    let alone = json(&finish(pathmark(folder.path(), &render)).with_code(0).out);
    let whole_s = start.elapsed().as_secs_f64();
    let checkpoint = folder.path().join("c");
    let mut launchers = vec!["mpiexec.mpich", "mpiexec.openmpi"];
    launchers.retain(|name| is_launcher(name));
    if launchers.is_empty() {
        launchers.push("mpiexec");
    }
    let mut random = Pcg64::seed_from_u64(1);
    let (mut kills, mut resumed) = (0, 0);
    let enough = if is_thorough() { 200 } else { 2 };
    while kills < enough || resumed == 0 {
        fs::remove_file(&checkpoint).ok();
        let image = loop {
            let count = random.random_range(1..4);
            let rule = RULES[random.random_range(0..RULES.len())];
            if count == 1 && rule.starts_with("master-worker") {
                continue;
            }
            let after = Duration::from_secs_f64(random.random_range(0.0..2.0) * whole_s);
            let name = launchers[random.random_range(0..launchers.len())];
            watchdog.now(format!("{name}: {count} ranks by {rule}, killed after {after:?}"));
            let mut command = launcher_named(name, folder.path());
            command.args(["-n", &count.to_string()]).arg(program()).args(render);
            command.args(["--checkpoint", "c", "--ranks", rule]);
            let finished = with_a_rank_killed(command, count, after, random.random_range(0..count));
            assert!(!finished.err.contains("panicked"), "{}", finished.err);
            if finished.code == Some(0) {
                break json(&finished.out);
            }
            kills += 1;
            resumed += usize::from(checkpoint.exists());
        };
        assert_eq!(image["checksum"], alone["checksum"], "after {kills} kills");
    }
    println!("{kills} kills of ranks of {launchers:?}, {resumed} with a checkpoint to go on from");
}
