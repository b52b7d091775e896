//! What happened on the paths of a film, over all rounds and all processes that rendered it.

use super::invalid::{InvalidSample, TOLD};
use crate::film::SAMPLE_BLOCK;
use crate::kernel::Counts;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The counts of a film's samples, each sample once. A checkpoint keeps them: a film that is continued has all that happened in it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct History {
    /// Of the samples that stay as they are.
    whole: Counts,
    /// Of the unfinished block at the end, which the next round renders again.
    open: Counts,
    /// Some invalid samples: the first of the first round that had any, and those of later rounds while there were few.
    pub(super) invalid: Vec<InvalidSample>,
}

impl History {
    /// Of all samples.
    pub(super) fn counts(&self) -> Counts {
        let mut counts = self.whole;
        counts.add(&self.open);
        counts
    }

    /// Begins a round, which renders the unfinished block again.
    pub(super) fn begin_round(&mut self) {
        self.open = Counts::default();
    }

    /// Adds a piece of one of the round's sections.
    pub(super) fn add(&mut self, section: &Range<u32>, counts: &Counts) {
        let is_open = section.end - section.start < SAMPLE_BLOCK;
        if is_open { &mut self.open } else { &mut self.whole }.add(counts);
    }

    /// Whether more invalid samples are worth looking for.
    pub(super) fn tells_few(&self) -> bool {
        self.invalid.len() < TOLD
    }

    /// Adds invalid samples, some of which may be there already.
    pub(super) fn tell(&mut self, found: Vec<InvalidSample>) {
        for sample in found {
            if self.tells_few() && !self.invalid.contains(&sample) {
                self.invalid.push(sample);
            }
        }
    }
}
