//! How pieces get from the workers into the film: `--output slots | channel-piece | channel-pixel | locked | row-progress |
//! printed-progress | shared-sum`.
//!
//! Outputs differ only in how a worker waits when it delivers; the schedule is the same. The image is the same to the
//! last bit: the film is put together by place, never by arrival.
//!
//! To add one: a file with its `ENTRY` and a type that implements [`Output`], and its line in `outputs!` below.

mod channel_piece;
mod channel_pixel;
mod locked;
mod printed_progress;
mod row_progress;
mod shared_sum;
mod slots;

use crate::error::Result;
use crate::film::{Film, Plan, Sections};
use crate::kernel::{Counts, Kernel};
use std::sync::Arc;

/// The place to which the workers of one run deliver.
pub(super) trait Output: Send + Sync {
    /// Renders the piece of job `index` and delivers it. No two calls have the same index.
    fn render(&self, index: usize, kernel: &dyn Kernel) -> Counts;

    /// A film for each section, when all pieces have been delivered.
    fn films(self: Box<Self>) -> Vec<Film>;
}

pub(super) struct Delivery {
    pub(super) plan: Arc<Plan>,
    /// Empty films for them, made before the run, so that a refused allocation shows before the work.
    pub(super) films: Sections,
    pub(super) threads: usize,
}

pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    pub(super) new: fn(Delivery) -> Result<Box<dyn Output>>,
}

macro_rules! outputs {
    ($($module:ident),* $(,)?) => {
        /// The outputs, in the order in which they are listed; the first is the default.
        pub static OUTPUTS: &[Entry] = &[$($module::ENTRY),*];
    };
}

outputs! {
    slots,
    channel_piece,
    channel_pixel,
    locked,
    row_progress,
    printed_progress,
    shared_sum,
}
