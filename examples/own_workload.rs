//! A workload of one's own beside the path tracer: how long the Collatz sequences of many numbers are.
//!
//! `cargo run --release --example own_workload -- render collatz --size 100x100 --strategy rayon -o collatz.png`
//!
//! The whole command line is there: `list workloads` shows it, `render --trace`, `simulate` and experiments take it where a scene's name stands.

use pathmark::Lab;
use pathmark::kernel::workload::{Item, Workload};
use std::process::ExitCode;

/// Numbers that one item tries.
const NUMBERS: u64 = 500;

struct Collatz;

impl Workload for Collatz {
    fn about(&self) -> &'static str {
        "lengths of Collatz sequences: costs that nobody can predict"
    }

    fn run(&self, item: &Item) -> [f64; 3] {
        let first = 1 + NUMBERS * item.index();
        let lengths = (first..first + NUMBERS).map(length);
        let (longest, sum) = lengths.fold((0, 0), |(longest, sum), length| (length.max(longest), sum + length));
        let mean = sum as f64 / NUMBERS as f64;
        [longest as f64 / 500.0, mean / 200.0, 0.0]
    }
}

/// Steps until the number is 1.
fn length(mut number: u64) -> u64 {
    let mut steps = 0;
    while number != 1 {
        number = if number.is_multiple_of(2) { number / 2 } else { 3 * number + 1 };
        steps += 1;
    }
    steps
}

fn main() -> ExitCode {
    Lab::new().workload("collatz", Collatz).main()
}
