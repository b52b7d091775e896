//! Foreign load: the processor time that other programs, and the host of a virtual machine, take during a measurement.

use super::available_threads;
use super::usage::Usage;
use std::fmt;
use std::time::Instant;

/// Above this share of the processors' time, others count as a disturbance of the measurement.
pub(super) const FOREIGN_SHARE: f64 = 0.05;

/// The processor time of others since a start time.
#[derive(Debug, Clone, Copy)]
pub struct ForeignLoad {
    begun: Instant,
    before: Option<Usage>,
}

/// The shares of the processors' time that others took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForeignShares {
    /// Other programs' share.
    pub programs: f64,
    /// The share that the host of a virtual machine gave to others while this machine had work.
    pub host: f64,
    /// Elapsed seconds.
    pub seconds: f64,
}

impl ForeignLoad {
    /// Begins to measure.
    pub fn begin() -> Self {
        Self { begun: Instant::now(), before: Usage::now() }
    }

    /// The shares since; `None` if the system does not report them.
    pub fn shares(&self) -> Option<ForeignShares> {
        let seconds = self.begun.elapsed().as_secs_f64();
        let taken = Usage::now()?.since(&self.before?);
        let capacity_s = seconds * available_threads() as f64;
        Some(ForeignShares { programs: taken.foreign_s? / capacity_s, host: taken.steal_s? / capacity_s, seconds })
    }

    /// A warning, if others took so much that they disturbed the measurement.
    pub fn warning(&self) -> Option<String> {
        let shares = self.shares().filter(|shares| shares.programs.max(shares.host) > FOREIGN_SHARE)?;
        Some(format!("warning: {shares}"))
    }
}

impl fmt::Display for ForeignShares {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [programs, host] = [self.programs, self.host].map(|share| 100.0 * share);
        write!(f, "other programs took {programs:.1} % of the processors in these {:.0} s", self.seconds)?;
        if host < 0.05 { Ok(()) } else { write!(f, ", and the host of this virtual machine {host:.1} %") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The load itself is unknown; the test only checks that it is a share.
    #[test]
    fn foreign_load_is_a_share() {
        let load = ForeignLoad::begin();
        while load.begun.elapsed().as_secs_f64() < 0.05 {
            std::hint::spin_loop();
        }
        if let Some(shares) = load.shares() {
            assert!(shares.programs >= 0.0 && shares.host >= 0.0 && shares.seconds >= 0.05, "{shares:?}");
        }
    }

    #[test]
    fn the_host_is_told_apart_from_programs() {
        let shares = ForeignShares { programs: 0.031, host: 0.12, seconds: 4.2 };
        let told = "other programs took 3.1 % of the processors in these 4 s";
        assert_eq!(shares.to_string(), format!("{told}, and the host of this virtual machine 12.0 %"));
        assert_eq!(ForeignShares { host: 0.0, ..shares }.to_string(), told);
    }
}
