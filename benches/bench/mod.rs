//! A bench program: criterion measures, its output goes into a file, and tables of its stored results end the run.
//!
//! With a flag of criterion (`--verbose`, `--list`, `--test` and so on) it prints as usual. With
//! `PATHMARK_BENCH_OUT=DIR` the cases of `scheduling` are also written into that results folder, where
//! `pathmark report DIR` finds them.

mod stored;
mod table;

use criterion::Criterion;
use nix::unistd::{dup, dup2_stderr, dup2_stdout};
use pathmark::measure::{ForeignLoad, Machine};
use pathmark::report::{BenchRow, write_benches};
use std::fs::{File, create_dir_all};
use std::io::{IsTerminal, stderr, stdout};
use std::os::fd::OwnedFd;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// The program whose cases go into a results folder, and its group with a table of speedups.
const OF_SPEEDUPS: &str = "scheduling";

/// Runs the bench program `name`. `units` are pairs: a group, or the beginning of the names of groups, and the unit of
/// their elements.
pub(crate) fn run(name: &str, units: &[(&str, &str)], cases: impl FnOnce(&mut Criterion)) {
    let (start, load) = (SystemTime::now(), ForeignLoad::begin());
    let mut criterion = Criterion::default().without_plots().nresamples(2000).configure_from_args();
    let is_quiet = std::env::args().skip(1).all(|argument| argument == "--bench" || !argument.starts_with('-'));
    let aside = if is_quiet { Aside::begin(name) } else { None };
    cases(&mut criterion);
    criterion.final_summary();
    drop(aside);
    let rows = stored::since(start);
    if rows.is_empty() {
        return;
    }
    if name == OF_SPEEDUPS {
        write(name, &rows);
    }
    for (group, unit) in units {
        let mut own: Vec<&BenchRow> = rows.iter().filter(|row| row.group.starts_with(group)).collect();
        while let Some(name) = own.first().map(|row| row.group.as_str()) {
            let (first, others): (Vec<_>, Vec<_>) = own.iter().copied().partition(|row| row.group == name);
            match first.iter().find(|row| row.case == "serial") {
                Some(serial) if name == OF_SPEEDUPS => table::print_speedups(name, serial, &first),
                _ => table::print_cases(name, unit, &first),
            }
            own = others;
        }
    }
    println!("\n{}.", Machine::look().line());
    if let Some(shares) = load.shares() {
        println!("During these cases {shares}.");
    }
    println!(
        "Cases ran one after the other, so a drift of the machine is in the tables; `pathmark run thread-scaling`"
    );
    println!("interleaves them and tells which runs were disturbed.");
}

fn write(name: &str, rows: &[BenchRow]) {
    let Some(out) = std::env::var_os("PATHMARK_BENCH_OUT") else { return };
    let filter: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let filter = if filter.is_empty() { String::new() } else { format!(" -- {}", filter.join(" ")) };
    if let Err(error) = write_benches(Path::new(&out), format!("cargo bench --bench {name}{filter}"), rows) {
        eprintln!("{error}");
    }
}

/// Redirects the program's output into a file while it lives. On a terminal standard error stays, because criterion
/// writes its progress line there.
struct Aside {
    file: PathBuf,
    stdout: OwnedFd,
    stderr: Option<OwnedFd>,
}

impl Aside {
    /// Starts the redirection; `None` if no file can be written, and then criterion prints.
    fn begin(name: &str) -> Option<Self> {
        let folder = stored::folder();
        create_dir_all(&folder).ok()?;
        let path = folder.join(format!("{name}.txt"));
        let file = File::create(&path).ok()?;
        println!("{name}: criterion's own lines go to {}", path.display());
        let shows_progress = stdout().is_terminal();
        let kept = Self {
            file: path,
            stdout: dup(stdout()).ok()?,
            stderr: if shows_progress { None } else { Some(dup(stderr()).ok()?) },
        };
        dup2_stdout(&file).ok()?;
        if kept.stderr.is_some() {
            dup2_stderr(&file).ok()?;
        }
        Some(kept)
    }
}

impl Drop for Aside {
    fn drop(&mut self) {
        dup2_stdout(&self.stdout).unwrap_or_default();
        if let Some(kept) = &self.stderr {
            dup2_stderr(kept).unwrap_or_default();
        }
        if std::thread::panicking() {
            eprintln!("a bench failed; {} says how", self.file.display());
        }
    }
}
