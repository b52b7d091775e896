//! Facts about the processors during a run, read outside the time that is measured.

use super::counters::{COUNTERS, Counted, Counters, Readings, between};
use crate::machine::{allowed_cpus, clock_mhz};
use std::path::Path;

/// The facts of a round, or of several.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Observed {
    /// Times that a worker began a job on another processor than its job before.
    pub(super) migrations: Option<u64>,
    /// The mean clock of the processors before and after.
    pub(super) clock_mhz: [Option<f64>; 2],
    /// Events that the processors counted.
    pub(super) counted: Counted,
}

/// The beginning of a round.
pub(super) struct Before {
    clock_mhz: Option<f64>,
    readings: Readings,
}

fn clock() -> Option<f64> {
    clock_mhz(Path::new("/"), &allowed_cpus())
}

impl Before {
    /// Reads the clock of the processors, and then the counters, if there are any.
    pub(super) fn now(counters: Option<&mut Counters>) -> Self {
        Self { clock_mhz: clock(), readings: counters.map(Counters::read).unwrap_or_default() }
    }

    /// The facts since then. The migrations are in the ledger.
    pub(super) fn observed(&self, counters: Option<&mut Counters>) -> Observed {
        let readings = counters.map(Counters::read).unwrap_or_default();
        let counted = between(&self.readings, &readings);
        Observed { migrations: None, clock_mhz: [self.clock_mhz, clock()], counted }
    }
}

impl Observed {
    /// The facts of two rounds that follow each other.
    pub(super) fn plus(&self, later: &Self) -> Self {
        let sum = |own: Option<u64>, other: Option<u64>| Some(own?.saturating_add(other?));
        Self {
            migrations: sum(self.migrations, later.migrations),
            clock_mhz: [self.clock_mhz[0], later.clock_mhz[1]],
            counted: std::array::from_fn(|place| sum(self.counted[place], later.counted[place])),
        }
    }

    /// The counters that the system did not grant.
    pub(super) fn missing_counters(&self) -> impl Iterator<Item = &'static str> {
        let counted = self.counted;
        COUNTERS.into_iter().zip(counted).filter(|(_, events)| events.is_none()).map(|(name, _)| name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_add_up_between_the_first_clock_and_the_last() {
        let first = Observed {
            migrations: Some(2),
            clock_mhz: [Some(1.0), Some(2.0)],
            counted: [Some(5), None, Some(1), None],
        };
        let second = Observed {
            migrations: Some(3),
            clock_mhz: [Some(3.0), Some(4.0)],
            counted: [Some(6), Some(1), None, None],
        };
        let both = first.plus(&second);
        assert_eq!((both.migrations, both.clock_mhz), (Some(5), [Some(1.0), Some(4.0)]));
        assert_eq!(both.counted, [Some(11), None, None, None]);
        assert_eq!(both.missing_counters().collect::<Vec<_>>(), ["instructions", "cache misses", "branch misses"]);
    }
}
