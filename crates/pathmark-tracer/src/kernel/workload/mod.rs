//! Workloads: work of unequal cost, cut into jobs, with a result that can be checked. The path tracer is one workload;
//! this folder has others, so that strategies can be compared on more than one program.
//!
//! A workload fills a film: each pixel and sample is an item with a value. Decompositions, outputs, traces, checksums
//! and the simulator therefore work as for a scene. So do `pathmark render mandelbrot`, `scene = ["mandelbrot"]` in an
//! experiment and `--size 1x1000 --decomposition rows` (a thousand jobs of one item). A workload has no estimator and
//! no sampler.
//!
//! To add one: write its file with a type that implements [`Workload`], and give it a line in [`WORKLOADS`].

mod costs;
mod mandelbrot;
mod sum;

use super::render::{Counts, Kernel};
use crate::film::{Piece, SampleSum, TileBuffer};
use crate::math::Rgb;
use std::fmt;
use std::sync::Arc;

pub use costs::{Costs, Distribution};
pub use mandelbrot::Mandelbrot;
pub use sum::Sum;

/// Name of the kernel in records of a workload.
pub const WORKLOAD: &str = "workload";

/// One item of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Item {
    pub x: u32,
    pub y: u32,
    pub width: u32,
    pub height: u32,
    /// Number of the sample, from 0.
    pub sample: u32,
    pub seed: u64,
}

impl Item {
    /// Number of the item, row by row.
    pub fn index(&self) -> u64 {
        u64::from(self.y) * u64::from(self.width) + u64::from(self.x)
    }

    /// Number of items per sample.
    pub fn count(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// Work of unequal cost with a result.
pub trait Workload: Send + Sync + 'static {
    /// A description in one line, for `pathmark list workloads`.
    fn about(&self) -> &'static str {
        "a workload from outside"
    }

    /// Prepares the data that all items share, before the clock starts.
    fn prepare(&self) {}

    /// Runs the item and returns its result: three finite numbers that are not negative. They depend on the item alone,
    /// not on the caller or the number of calls.
    fn run(&self, item: &Item) -> [f64; 3];
}

#[derive(Clone)]
pub struct Entry {
    /// The name, valid wherever a scene's name is.
    pub name: &'static str,
    workload: Made,
}

#[derive(Clone)]
enum Made {
    BuiltIn(&'static dyn Workload),
    Own(Arc<dyn Workload>),
}

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Entry").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Entry {
    /// A user-defined workload.
    pub fn custom(name: &'static str, workload: impl Workload) -> Self {
        Self { name, workload: Made::Own(Arc::new(workload)) }
    }

    const fn built_in(name: &'static str, workload: &'static dyn Workload) -> Self {
        Self { name, workload: Made::BuiltIn(workload) }
    }

    fn workload(&self) -> &dyn Workload {
        match &self.workload {
            Made::BuiltIn(workload) => *workload,
            Made::Own(workload) => &**workload,
        }
    }

    pub fn about(&self) -> &'static str {
        self.workload().about()
    }

    /// The kernel that runs the items.
    pub fn kernel(&self, width: u32, height: u32, seed: u64) -> Box<dyn Kernel> {
        self.workload().prepare();
        Box::new(OfWorkload { entry: self.clone(), width, height, seed })
    }
}

/// The workloads, in the order in which they are listed.
pub static WORKLOADS: &[Entry] = &[
    Entry::built_in("mandelbrot", &Mandelbrot),
    Entry::built_in("costs-uniform", &Costs(Distribution::Uniform)),
    Entry::built_in("costs-exponential", &Costs(Distribution::Exponential)),
    Entry::built_in("costs-bimodal", &Costs(Distribution::Bimodal)),
    Entry::built_in("costs-giant", &Costs(Distribution::Giant)),
    Entry::built_in("costs-sorted", &Costs(Distribution::Sorted)),
    Entry::built_in("sum", &Sum),
];

struct OfWorkload {
    entry: Entry,
    width: u32,
    height: u32,
    seed: u64,
}

impl Kernel for OfWorkload {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let workload = self.entry.workload();
        let (mut counts, mut sum) = (Counts::default(), SampleSum::default());
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                sum.clear();
                for sample in piece.samples.clone() {
                    let Self { width, height, seed, .. } = *self;
                    let [r, g, b] = workload.run(&Item { x, y, width, height, sample, seed });
                    let value = Rgb { r, g, b };
                    counts.paths += 1;
                    counts.invalid += u64::from(!value.is_valid_radiance());
                    sum.add(if value.is_valid_radiance() { value } else { Rgb::BLACK });
                }
                *pixel = sum.total();
            }
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every item has a valid result that depends on the item alone.
    #[test]
    fn results_are_valid_and_repeat() {
        for entry in WORKLOADS {
            for (index, sample) in (0..64).flat_map(|index| [(index, 0), (index, 3)]) {
                let item = Item { x: index % 8, y: index / 8, width: 8, height: 8, sample, seed: 5 };
                let result = entry.workload().run(&item);
                assert!(result.iter().all(|number| number.is_finite() && *number >= 0.0), "{}: {result:?}", entry.name);
                assert_eq!(result, entry.workload().run(&item), "{}", entry.name);
            }
        }
    }
}
