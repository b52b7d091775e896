//! A bench program: criterion measures and prints each case, and tables of its stored results end the run.
//!
//! With `PATHMARK_BENCH_OUT=DIR` the cases of `scheduling` are also written into that results folder, where
//! `pathmark report DIR` finds them.

mod stored;
mod table;

use criterion::Criterion;
use pathmark::measure::{ForeignLoad, Machine};
use pathmark::report::{BenchRow, write_benches};
use std::path::Path;
use std::time::SystemTime;

/// The program whose cases go into a results folder, and its group with a table of speedups.
const OF_SPEEDUPS: &str = "scheduling";

/// Runs the bench program `name`. `units` are pairs: a group, or the beginning of the names of groups, and the unit of
/// their elements.
pub(crate) fn run(name: &str, units: &[(&str, &str)], cases: impl FnOnce(&mut Criterion)) {
    let (start, load) = (SystemTime::now(), ForeignLoad::begin());
    let mut criterion = Criterion::default().without_plots().nresamples(2000).configure_from_args();
    cases(&mut criterion);
    criterion.final_summary();
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
