//! Work inflation: how many times as long jobs take while several workers are busy, measured on this machine.
//!
//! Processors share cores, caches, memory and clock rates, and a host takes processors away. Jobs then take longer than
//! in a serial run, whatever the schedule. A run's own inflation is known only after the run, so its prediction takes
//! the inflation of other repetitions.

use crate::analysis::quantile::median;
use std::collections::BTreeMap;

/// The seconds inside jobs of a run, over those of the serial run in the same repetition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BusyRatio {
    pub workers: usize,
    pub repetition: u32,
    pub ratio: f64,
}

/// Factors over numbers of workers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WorkInflation {
    /// For each number of workers, ascending, the median ratio of each repetition's runs.
    repetitions: BTreeMap<usize, Vec<f64>>,
}

impl WorkInflation {
    /// Gathers the ratios of all repetitions but `left_out`. Runs of one repetition share a serial run, so they count as
    /// one value.
    pub fn of(ratios: &[BusyRatio], left_out: Option<u32>) -> Self {
        let mut runs: BTreeMap<(usize, u32), Vec<f64>> = BTreeMap::new();
        for one in ratios.iter().filter(|one| Some(one.repetition) != left_out) {
            runs.entry((one.workers, one.repetition)).or_default().push(one.ratio);
        }
        let mut repetitions: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for ((workers, _), ratios) in runs {
            repetitions.entry(workers).or_default().extend(median(&ratios));
        }
        Self { repetitions }
    }

    /// The factor of the largest measured number of workers up to `workers`; `None` if none was measured.
    pub fn at(&self, workers: usize) -> Option<f64> {
        median(self.repetitions.range(..=workers).next_back()?.1)
    }

    /// The largest measured number of workers, and one factor for each repetition.
    pub fn largest(&self) -> Option<(usize, &[f64])> {
        self.repetitions.iter().next_back().map(|(workers, factors)| (*workers, factors.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratios() -> Vec<BusyRatio> {
        let of = |workers, repetition, ratios: [f64; 3]| ratios.map(|ratio| BusyRatio { workers, repetition, ratio });
        [of(1, 0, [1.0; 3]), of(2, 0, [1.1, 1.2, 9.0]), of(2, 1, [1.3; 3]), of(2, 2, [1.4; 3])].concat()
    }

    #[test]
    fn a_repetition_counts_once() {
        let all = WorkInflation::of(&ratios(), None);
        assert_eq!(all.largest(), Some((2, &[1.2, 1.3, 1.4][..])));
        assert_eq!((all.at(1), all.at(2), all.at(64)), (Some(1.0), Some(1.3), Some(1.3)));
    }

    #[test]
    fn a_repetition_can_be_left_out() {
        let others = WorkInflation::of(&ratios(), Some(0));
        assert_eq!((others.at(1), others.at(2)), (None, Some(1.35)));
        assert_eq!(WorkInflation::default().at(4), None);
    }
}
