//! A part of a sweep: `run EXPERIMENT --shard 2/4`.

use super::Cell;
use super::cell::with_serial_runs;
use crate::error::{InputError, Result};
use crate::film::{Shard, ShardCut};
use std::fmt;

/// One of `count` parts of the cells of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepShard {
    /// The number of the part, from 1.
    pub(super) index: u32,
    pub(super) count: u32,
}

impl fmt::Display for SweepShard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl SweepShard {
    pub fn parse(text: &str) -> Result<Self> {
        // Parts of images are numbered in the same way; how those are cut does not matter here.
        let shard = Shard::parse(text, ShardCut::Tiles)?;
        Ok(Self { index: shard.index(), count: shard.count() })
    }

    /// The cells of this part: every n-th, and the serial runs that they are compared with.
    pub(super) fn cells(self, cells: &[Cell]) -> Result<Vec<Cell>> {
        let own = |index: usize| index % self.count as usize == self.index as usize - 1;
        let (serial, others): (Vec<&Cell>, Vec<&Cell>) = cells.iter().partition(|cell| cell.settings.is_serial());
        // If all cells are serial, they are compared with nothing and are divided themselves.
        let has_baselines = !others.is_empty();
        let divided = if has_baselines { others } else { serial };
        if self.count as usize > divided.len() {
            let problem = "there are more parts than cells to divide";
            let error = InputError::new("shard", self.to_string(), problem);
            return Err(error.allowed(format!("I/N with N at most {}", divided.len())).into());
        }
        let mine: Vec<&Cell> =
            divided.into_iter().enumerate().filter(|(index, _)| own(*index)).map(|(_, cell)| cell).collect();
        Ok(with_serial_runs(cells, &mine, has_baselines))
    }

    /// The number of this part's repetition `own` among the repetitions of all parts; `None` beyond the largest one.
    pub(super) fn repetition(self, own: u32) -> Option<u32> {
        own.checked_mul(self.count)?.checked_add(self.index - 1)
    }
}
