//! The tables at the end of a bench program.

use super::BenchRow;
use std::collections::BTreeSet;

/// Columns of a table of cases by parameters; with one more, lines would wrap.
const COLUMNS: usize = 7;

/// Prints the cases of a group: nanoseconds for an element, with half of the confidence interval.
pub(super) fn print_cases(group: &str, unit: &str, rows: &[&BenchRow]) {
    println!("\n{group}: nanoseconds for a {unit}, median and half of its 95 % interval");
    let mut parameters: Vec<&str> = Vec::new();
    for row in rows {
        if !parameters.contains(&row.parameter.as_str()) {
            parameters.push(&row.parameter);
        }
    }
    let cases: BTreeSet<&str> = rows.iter().map(|row| row.case.as_str()).collect();
    let width = cases.iter().map(|case| case.len()).max().unwrap_or(0).max(8);
    for columns in parameters.chunks(COLUMNS) {
        print!("{:width$}", "");
        println!("{}", cells_of(columns));
        for case in &cases {
            let cell = |parameter: &&str| rows.iter().find(|row| row.case == **case && row.parameter == **parameter);
            let cells: Vec<String> =
                columns.iter().map(|name| cell(name).map(|row| told(row)).unwrap_or_default()).collect();
            if cells.iter().any(|cell| !cell.is_empty()) {
                println!("{case:width$}{}", cells_of(&cells));
            }
        }
    }
}

fn cells_of<T: std::fmt::Display>(cells: &[T]) -> String {
    cells.iter().fold(String::new(), |line, cell| format!("{line} {cell:>15}"))
}

fn told(row: &BenchRow) -> String {
    let ns = 1e9 * row.median_s / row.elements as f64;
    let decimals = if ns >= 1000.0 {
        0
    } else if ns >= 100.0 {
        1
    } else {
        2
    };
    let percent = 50.0 * (row.high_s - row.low_s) / row.median_s;
    format!("{ns:.decimals$} \u{b1}{percent:>4.1}%")
}
