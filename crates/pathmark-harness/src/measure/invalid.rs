//! The places of a run's invalid samples. Kernels only count them. A sample can be rendered again from its address, so
//! the few that are reported are searched for afterwards, and a run without any pays nothing.

use crate::film::{Piece, Plan};
use crate::kernel::{Counts, Kernel, one_sample};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A sample that was NaN, infinite or negative, with its address: `pathmark inspect path --pixel X,Y --sample K` renders it
/// again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InvalidSample {
    /// Row, from the top.
    pub y: u32,
    /// Column, from the left.
    pub x: u32,
    /// The number of the sample within the pixel.
    pub sample: u32,
}

impl fmt::Display for InvalidSample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.x, self.y, self.sample)
    }
}

/// The most invalid samples that are reported.
pub(super) const TOLD: usize = 10;

/// The first invalid samples of the pieces, by row, column and number, whatever the decomposition. `counts` has the
/// counts of each piece.
pub(super) fn first_invalid(kernel: &dyn Kernel, plan: &Plan, counts: &[Counts]) -> Vec<InvalidSample> {
    let affected: Vec<&Piece> =
        plan.pieces().iter().zip(counts).filter(|(_, counts)| counts.invalid > 0).map(|(piece, _)| piece).collect();
    let first = affected.iter().map(|piece| piece.bounds.y0).min().unwrap_or(0);
    let last = affected.iter().map(|piece| piece.bounds.y1).max().unwrap_or(0);
    let mut found = Vec::new();
    for y in first..last {
        let mut in_row: Vec<InvalidSample> = Vec::new();
        for piece in affected.iter().filter(|piece| (piece.bounds.y0..piece.bounds.y1).contains(&y)) {
            for x in piece.bounds.x0..piece.bounds.x1 {
                let samples = piece.samples.clone().map(|sample| InvalidSample { y, x, sample });
                in_row.extend(samples.filter(|at| one_sample(kernel, [at.x, at.y], at.sample).1.invalid > 0));
            }
        }
        in_row.sort_unstable();
        found.extend(in_row);
        if found.len() >= TOLD {
            found.truncate(TOLD);
            break;
        }
    }
    found
}
