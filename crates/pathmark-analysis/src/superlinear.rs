//! Superlinear speedup: the likely cause of a speedup above the number of workers, as far as the recorded evidence
//! tells.
//!
//! A work-conserving schedule on p equal cores can't be more than p times as fast as the best serial program (V. Faber,
//! O. M. Lubeck and A. B. White, "Superlinear speedup of an efficient sequential algorithm is not possible", Parallel
//! Computing 3, 1986). A speedup above p therefore shows that something else differed between the two runs. The first
//! cause with evidence is named; none is guessed.

use std::fmt;

use serde::Serialize;

use super::interval::Interval;

/// Evidence recorded beside a speedup.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Evidence {
    /// Time of the serial baseline over the strategy's own time at one worker.
    pub at_one_worker: Option<Interval>,
    /// Number of warnings of the runs: load of other programs, changing clocks and the like.
    pub warnings: usize,
    /// Logical processors of the machine.
    pub processors: Option<usize>,
    pub physical_cores: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// The strategy is already faster than the baseline at one worker.
    SlowBaseline,
    /// The runs carry warnings.
    Disturbance,
    /// Logical processors share cores.
    SharedCores,
    /// No recorded evidence explains it.
    Unexplained,
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SlowBaseline => "likely cause: the baseline is slower than the strategy at one worker",
            Self::Disturbance => "likely cause: load of others or a changing clock, of which the runs carry warnings",
            Self::SharedCores => {
                "likely cause: processors share cores (SMT), so that the baseline may have had less than a core to itself"
            }
            Self::Unexplained => "unexplained: nothing that was recorded tells why",
        })
    }
}

/// Returns the first cause with evidence, with the strongest evidence first.
pub fn cause(evidence: &Evidence) -> Cause {
    let shared = evidence.processors.zip(evidence.physical_cores).is_some_and(|(logical, cores)| logical > cores);
    if evidence.at_one_worker.is_some_and(|speedup| speedup.low > 1.0) {
        Cause::SlowBaseline
    } else if evidence.warnings > 0 {
        Cause::Disturbance
    } else if shared {
        Cause::SharedCores
    } else {
        Cause::Unexplained
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_evidence_is_called_a_cause() {
        for cause in [Cause::SlowBaseline, Cause::Disturbance, Cause::SharedCores] {
            assert!(cause.to_string().starts_with("likely cause: "));
        }
        assert!(Cause::Unexplained.to_string().starts_with("unexplained"));
    }
}
