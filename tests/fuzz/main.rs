//! F04, F09: files with any damage. Each target reads its seeds, every prefix of each short seed, and mutations drawn
//! from a fixed seed. A reader may accept or refuse. It may not panic, use more memory than a refusal may take, or
//! compute for a second.
//!
//! `PATHMARK_THOROUGH=1` draws a hundred times as many mutations. A failing input is written to a file, and its path is
//! printed: add it to `corpus/TARGET`, where this program finds it by itself.

mod mutate;
mod targets;
#[path = "../support/watchdog.rs"]
mod watchdog;

use mutate::Mutator;
use nix::sys::resource::{UsageWho, getrusage};
use peak_alloc::PeakAlloc;
use std::any::Any;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use targets::{TARGETS, Target};
use watchdog::Watchdog;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Memory in bytes that a reader may use for a file of some thousand bytes.
const MOST_MEMORY: usize = 256 << 20;
/// CPU time, which does not depend on the machine's other work.
const LONGEST: Duration = Duration::from_secs(1);
/// Every prefix of a shorter seed is read.
const LONGEST_CUT: usize = 1100;
/// After so many failures of one target, more would show nothing new.
const MOST_FAILURES: usize = 5;

/// The results of a target after all its inputs.
#[derive(Default)]
struct Tally {
    inputs: u64,
    accepted: u64,
    most_memory: usize,
    longest: Duration,
    failures: Vec<String>,
}

/// Whose processor time is read. Only Linux counts it for a thread; elsewhere, work of other threads counts, too.
#[cfg(target_os = "linux")]
const WHO: UsageWho = UsageWho::RUSAGE_THREAD;
#[cfg(not(target_os = "linux"))]
const WHO: UsageWho = UsageWho::RUSAGE_SELF;

fn cpu_time() -> Duration {
    let usage = getrusage(WHO).unwrap();
    [usage.user_time(), usage.system_time()]
        .map(|time| Duration::new(time.tv_sec() as u64, time.tv_usec() as u32 * 1000))
        .iter()
        .sum()
}

fn said(payload: &(dyn Any + Send)) -> &str {
    payload.downcast_ref::<String>().map_or_else(|| payload.downcast_ref().copied().unwrap_or("?"), String::as_str)
}

impl Tally {
    /// Reads one input and records a problem, if there is one.
    fn read(&mut self, target: &Target, path: &Path, input: &[u8]) {
        fs::write(path, input).unwrap();
        MEMORY.reset_peak_usage();
        let (before, start, cpu) = (MEMORY.current_usage(), Instant::now(), cpu_time());
        let outcome = catch_unwind(AssertUnwindSafe(|| (target.read)(path)));
        let took = if start.elapsed() > LONGEST { cpu_time().saturating_sub(cpu) } else { start.elapsed() };
        let memory = MEMORY.peak_usage().saturating_sub(before);
        self.inputs += 1;
        self.longest = self.longest.max(took);
        self.most_memory = self.most_memory.max(memory);
        let problem = match outcome {
            Err(payload) => format!("panics: {}", said(&*payload)),
            Ok(_) if memory > MOST_MEMORY => format!("takes {} MiB", memory >> 20),
            Ok(_) if took > LONGEST => format!("takes {took:?}"),
            Ok(accepted) => {
                self.accepted += u64::from(accepted);
                return;
            }
        };
        let kept = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{}", target.name, self.inputs));
        fs::write(&kept, input).unwrap();
        self.failures.push(format!("{}: {problem}; the input is in {}", target.name, kept.display()));
    }
}

/// The seeds of a target: the files of its folder, and the seeds that the program makes or carries.
fn seeds(target: &Target) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(target.name);
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let kept = paths.iter().map(|path| fs::read(path).unwrap());
    kept.chain((target.more)()).collect()
}

fn try_all(target: &Target, rounds: u64, watchdog: &Watchdog) -> Tally {
    // In memory if there is such a folder: a disk takes longer than all readers together.
    let folder = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
    (target.prepare)(folder.path());
    let path = folder.path().join(target.file);
    let seeds = seeds(target);
    let mut tally = Tally::default();
    watchdog.now(format!("{}: on an input that is in {}", target.name, path.display()));
    for input in &seeds {
        tally.read(target, &path, input);
    }
    assert!(tally.accepted > 0, "{}: no seed is accepted", target.name);
    let short = seeds.iter().filter(|input| target.cut && input.len() < LONGEST_CUT);
    for input in short.flat_map(|input| (0..input.len()).map(|end| &input[..end])) {
        tally.read(target, &path, input);
    }
    let mut mutator = Mutator::new(&seeds, target.words);
    for number in 0..target.mutations * rounds {
        if number.is_multiple_of(64) {
            watchdog.now(format!("{}: on an input that is in {}", target.name, path.display()));
        }
        let input = (target.repair)(mutator.next());
        tally.read(target, &path, &input);
        if tally.failures.len() >= MOST_FAILURES {
            break;
        }
    }
    tally
}

#[test]
fn no_file_makes_a_reader_panic_or_take_too_much() {
    let watchdog = Watchdog::new(Duration::from_mins(1));
    let rounds = if std::env::var_os("PATHMARK_THOROUGH").is_some() { 100 } else { 1 };
    let (mut inputs, mut failures) = (0, Vec::new());
    for target in TARGETS {
        let start = Instant::now();
        let tally = try_all(target, rounds, &watchdog);
        println!(
            "{:12} {:8} inputs, {:5.1} % accepted, most memory {:6.1} MiB, longest {:6.1} ms, {:5.1} s in all",
            target.name,
            tally.inputs,
            100.0 * tally.accepted as f64 / tally.inputs as f64,
            tally.most_memory as f64 / f64::from(1 << 20),
            tally.longest.as_secs_f64() * 1e3,
            start.elapsed().as_secs_f64(),
        );
        inputs += tally.inputs;
        failures.extend(tally.failures);
    }
    println!("{inputs} inputs");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    assert!(inputs >= 30_000, "only {inputs} inputs");
}
