//! A custom workload beside the path tracer: the lengths of the Collatz sequences of many numbers.
//!
//! `cargo run --release --example custom_workload -- render collatz --size 100x100 --strategy rayon -o collatz.png`
//!
//! The whole command line works with it: `list workloads` shows it, and `render --trace`, `simulate` and experiments
//! take it in place of a scene's name.

use pathmark::Lab;
use pathmark::kernel::workload::{Item, Workload};
use std::process::ExitCode;

/// Number of Collatz sequences in one item.
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

/// Returns the number of steps until `number` is 1.
fn length(mut number: u64) -> u64 {
    let mut steps = 0;
    while number != 1 {
        number = if number.is_multiple_of(2) { number / 2 } else { 3 * number + 1 };
        steps += 1;
    }
    steps
}

fn main() -> ExitCode {
    pathmark::main(Lab::new().workload("collatz", Collatz))
}
