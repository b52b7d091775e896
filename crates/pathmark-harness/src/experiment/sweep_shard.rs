//! A part of a sweep: `run EXPERIMENT --shard 2/4`.

use super::Cell;
use crate::error::{InputError, Result};
use crate::film::{Shard, ShardCut};
use crate::measure::Settings;
use std::collections::HashSet;
use std::fmt;

/// One of `count` parts of the cells of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepShard {
    /// The number of the part, from 1.
    pub(super) index: u32,
    /// The number of parts.
    pub(super) count: u32,
}

impl fmt::Display for SweepShard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl SweepShard {
    /// Reads `2/4`.
    pub fn parse(text: &str) -> Result<Self> {
        // Parts of images are numbered in the same way; how those are cut does not matter here.
        let shard = Shard::parse(text, ShardCut::Tiles)?;
        Ok(Self { index: shard.index(), count: shard.count() })
    }

    /// The cells of this part: every n-th, and the serial runs that they are compared with.
    pub(super) fn cells(self, cells: &[Cell]) -> Result<Vec<Cell>> {
        let own = |index: usize| index % self.count as usize == self.index as usize - 1;
        let (serial, others): (Vec<Cell>, Vec<Cell>) = cells.iter().cloned().partition(Cell::is_serial);
        // If all cells are serial, they are compared with nothing and are divided themselves.
        let has_baselines = !others.is_empty();
        let divided = if has_baselines { others } else { serial };
        if self.count as usize > divided.len() {
            let problem = "there are more parts than cells to divide";
            let error = InputError::new("shard", self.to_string(), problem);
            return Err(error.allowed(format!("I/N with N at most {}", divided.len())).into());
        }
        let mine: Vec<Cell> =
            divided.into_iter().enumerate().filter(|(index, _)| own(*index)).map(|(_, cell)| cell).collect();
        let ids: HashSet<&str> = mine.iter().map(|cell| cell.id.as_str()).collect();
        let compared: HashSet<Settings> = mine.iter().map(Cell::without_schedule).collect();
        let is_needed = |cell: &Cell| has_baselines && cell.is_serial() && compared.contains(&cell.without_schedule());
        let is_of_part = |cell: &Cell| ids.contains(cell.id.as_str()) || is_needed(cell);
        Ok(cells.iter().filter(|cell| is_of_part(cell)).cloned().collect())
    }

    /// The number of this part's repetition `own` among the repetitions of all parts; `None` beyond the largest one.
    pub(super) fn repetition(self, own: u32) -> Option<u32> {
        own.checked_mul(self.count)?.checked_add(self.index - 1)
    }
}
