//! A bench program: criterion measures and prints each case, and tables of its stored results end the run.

mod stored;
mod table;

use criterion::Criterion;
use pathmark::measure::{ForeignLoad, Machine};
use std::time::SystemTime;

/// One case as criterion measured it.
struct BenchRow {
    /// Criterion's group: `scheduling`, `empty-jobs`, `seam` or `trace`.
    group: String,
    /// The case: in most groups a strategy.
    case: String,
    /// Its parameter: in most groups the threads.
    parameter: String,
    /// Samples or jobs of a round.
    elements: u64,
    /// Median seconds of a round.
    median_s: f64,
    /// Lower end of its 95 % interval.
    low_s: f64,
    high_s: f64,
}

/// Runs a bench program. `units` are pairs: a group, or the beginning of the names of groups, and the unit of their
/// elements.
pub(crate) fn run(units: &[(&str, &str)], cases: impl FnOnce(&mut Criterion)) {
    let (start, load) = (SystemTime::now(), ForeignLoad::begin());
    let mut criterion = Criterion::default().without_plots().nresamples(2000).configure_from_args();
    cases(&mut criterion);
    criterion.final_summary();
    let rows = stored::since(start);
    if rows.is_empty() {
        return;
    }
    for (group, unit) in units {
        let mut own: Vec<&BenchRow> = rows.iter().filter(|row| row.group.starts_with(group)).collect();
        while let Some(name) = own.first().map(|row| row.group.as_str()) {
            let (first, others): (Vec<_>, Vec<_>) = own.iter().copied().partition(|row| row.group == name);
            table::print_cases(name, unit, &first);
            own = others;
        }
    }
    println!("\n{}.", Machine::look().line());
    if let Some(shares) = load.shares() {
        println!("During these cases {shares}.");
    }
    println!("Cases ran one after the other, so a drift of the machine is in their times.");
}
