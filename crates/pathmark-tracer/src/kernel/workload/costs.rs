//! Costs drawn from a distribution: an item's seed and number determine the number of steps that it spins for. Steps
//! are counted, not timed, so every machine and every run executes the same work.

use super::{Item, Workload};
use crate::sampling::{mix, unit};

/// Mean number of steps of an item. A step is a multiplication and an addition that wait for the previous step: about a
/// nanosecond today.
const MEAN_STEPS: f64 = 4096.0;

/// Distributions of costs over the items, all with the same mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distribution {
    /// Any cost from zero to twice the mean.
    Uniform,
    /// Many cheap items, few expensive ones.
    Exponential,
    /// Nine of ten items cost a fifth of the mean; the tenth costs 8.2 times the mean.
    Bimodal,
    /// The middle item costs as much as all others together.
    Giant,
    /// The most expensive item first, then falling to zero.
    Sorted,
}

/// Items whose costs follow a distribution.
#[derive(Debug, Clone, Copy)]
pub struct Costs(pub Distribution);

impl Costs {
    /// The item's cost in units of the mean, from its number and a random number in [0, 1).
    fn cost(self, index: u64, count: u64, u: f64) -> f64 {
        let place = index as f64 / count as f64;
        match self.0 {
            Distribution::Uniform => 2.0 * u,
            Distribution::Exponential => -libm::log(1.0 - u),
            Distribution::Bimodal => {
                if u < 0.9 {
                    0.2
                } else {
                    8.2
                }
            }
            Distribution::Giant if index == count / 2 => 0.5 * count as f64,
            Distribution::Giant => 0.5 * count as f64 / (count.max(2) - 1) as f64,
            Distribution::Sorted => 2.0 * (1.0 - place) - 1.0 / count as f64,
        }
    }
}

impl Workload for Costs {
    fn about(&self) -> &'static str {
        match self.0 {
            Distribution::Uniform => "spins for uniformly distributed numbers of steps",
            Distribution::Exponential => "spins for exponentially distributed numbers of steps",
            Distribution::Bimodal => "spins for few steps; every tenth item takes 41 times as many",
            Distribution::Giant => "spins evenly, but the middle item costs as much as all others together",
            Distribution::Sorted => "spins for fewer and fewer steps; the most expensive item comes first",
        }
    }

    fn run(&self, item: &Item) -> [f64; 3] {
        let word = mix(mix(item.index()) ^ mix(item.seed ^ u64::from(item.sample) << 32));
        let steps = (MEAN_STEPS * self.cost(item.index(), item.count(), unit(word))) as u64;
        let mut state = word;
        for _ in 0..steps {
            // Knuth's MMIX generator: the compiler cannot shorten it.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        }
        [unit(state), unit(mix(state)), steps as f64 / MEAN_STEPS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every distribution has the same mean cost. The exponential's mean over 4096 midpoints misses its tail by less
    /// than 1e-3.
    #[test]
    fn costs_have_the_mean() {
        for kind in [
            Distribution::Uniform,
            Distribution::Exponential,
            Distribution::Bimodal,
            Distribution::Giant,
            Distribution::Sorted,
        ] {
            let count = 4096;
            let sum: f64 = (0..count).map(|index| Costs(kind).cost(index, count, (index as f64 + 0.5) / 4096.0)).sum();
            assert!((sum / 4096.0 - 1.0).abs() < 2e-3, "{kind:?}: {}", sum / 4096.0);
        }
    }
}
