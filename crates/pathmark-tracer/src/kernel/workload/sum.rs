//! A parallel sum: every item adds up numbers from memory. All items are cheap and cost the same, so a scheduler's
//! overhead shows at once.

use super::{Item, Workload};
use crate::sampling::{mix, unit};
use std::sync::LazyLock;

/// Numbers that an item adds up.
const SLICE: usize = 1 << 10;
/// Slices in memory: 8 MiB, more than most second-level caches hold. Items share them.
const SLICES: usize = 1 << 10;

static NUMBERS: LazyLock<Vec<f64>> = LazyLock::new(|| (0..(SLICE * SLICES) as u64).map(|n| unit(mix(n))).collect());

/// The sum of a slice of numbers in [0, 1).
#[derive(Debug, Clone, Copy)]
pub struct Sum;

impl Workload for Sum {
    fn about(&self) -> &'static str {
        "adds up 1024 numbers from memory: cheap items of equal cost"
    }

    fn prepare(&self) {
        LazyLock::force(&NUMBERS);
    }

    fn run(&self, item: &Item) -> [f64; 3] {
        let slice = item.index() as usize % SLICES;
        let sum: f64 = NUMBERS[slice * SLICE..][..SLICE].iter().sum();
        [sum / SLICE as f64; 3]
    }
}
