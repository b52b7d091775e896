//! Counts of a film's paths, over all rounds and all processes that rendered it, and the places of its invalid samples.
//!
//! Kernels only count invalid samples. A sample can be rendered again from its address, so the few that are reported are
//! searched for afterwards, and a run without any pays nothing.

use crate::film::{Piece, Plan, SAMPLE_BLOCK};
use crate::kernel::{Counts, Kernel, one_sample};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;

/// The counts of a film's samples, each sample once. A checkpoint keeps them, so a continued film has the counts of all
/// its rounds.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    whole: Counts,
    /// Counts of the unfinished block at the end, which the next round renders again.
    open: Counts,
    /// Some invalid samples: the first of the first round that had any, and those of later rounds while there are few.
    pub(super) invalid: Vec<InvalidSample>,
}

impl History {
    pub(super) fn counts(&self) -> Counts {
        let mut counts = self.whole;
        counts.add(&self.open);
        counts
    }

    /// Begins a round, which renders the unfinished block again.
    pub(super) fn begin_round(&mut self) {
        self.open = Counts::default();
    }

    /// Adds the counts of a piece of one of the round's sections.
    pub(super) fn add(&mut self, section: &Range<u32>, counts: &Counts) {
        let is_open = section.end - section.start < SAMPLE_BLOCK;
        if is_open { &mut self.open } else { &mut self.whole }.add(counts);
    }

    pub(super) fn tells_few(&self) -> bool {
        self.invalid.len() < TOLD
    }

    /// Adds invalid samples, some of which may be present already.
    pub(super) fn tell(&mut self, found: Vec<InvalidSample>) {
        for sample in found {
            if self.tells_few() && !self.invalid.contains(&sample) {
                self.invalid.push(sample);
            }
        }
    }
}

/// A sample that was NaN, infinite or negative, with its address: `pathmark inspect path --pixel X,Y --sample K` renders it
/// again.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct InvalidSample {
    pub y: u32,
    pub x: u32,
    pub sample: u32,
}

impl fmt::Display for InvalidSample {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}", self.x, self.y, self.sample)
    }
}

const TOLD: usize = 10;

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
