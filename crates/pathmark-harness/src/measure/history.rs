//! Counts of a film's paths, over all rounds and all processes that rendered it.

use super::invalid::{InvalidSample, TOLD};
use crate::film::SAMPLE_BLOCK;
use crate::kernel::Counts;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The counts of a film's samples, each sample once. A checkpoint keeps them, so a continued film has the counts of all
/// its rounds.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// Counts of the finished samples.
    whole: Counts,
    /// Counts of the unfinished block at the end, which the next round renders again.
    open: Counts,
    /// Some invalid samples: the first of the first round that had any, and those of later rounds while there are few.
    pub(super) invalid: Vec<InvalidSample>,
}

impl History {
    /// The counts of all samples.
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

    /// Whether to search for more invalid samples.
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
