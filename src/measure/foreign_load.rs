//! Foreign load: the processor time that other programs take during a measurement.

use super::available_threads;
use super::usage::Usage;
use std::time::Instant;

/// Above this share of the processors' time, other programs count as a disturbance of the measurement.
pub(super) const FOREIGN_SHARE: f64 = 0.05;

/// The processor time of other programs since a start time.
#[derive(Debug, Clone, Copy)]
pub struct ForeignLoad {
    begun: Instant,
    /// CPU seconds of all other programs on the machine until the start.
    before_s: Option<f64>,
}

impl ForeignLoad {
    /// Begins to measure.
    pub fn begin() -> Self {
        Self { begun: Instant::now(), before_s: foreign_s() }
    }

    /// The share of the processors' time that other programs have taken since, and the elapsed seconds; `None` if the
    /// system does not report it.
    pub fn share(&self) -> Option<(f64, f64)> {
        let seconds = self.begun.elapsed().as_secs_f64();
        let taken_s = (foreign_s()? - self.before_s?).max(0.0);
        Some((taken_s / (seconds * available_threads() as f64), seconds))
    }

    /// A warning, if they took so much that they disturbed the measurement.
    pub fn warning(&self) -> Option<String> {
        let (share, seconds) = self.share().filter(|(share, _)| *share > FOREIGN_SHARE)?;
        let percent = 100.0 * share;
        Some(format!("warning: other programs took {percent:.0} % of the processors in these {seconds:.0} s"))
    }
}

fn foreign_s() -> Option<f64> {
    Usage::now()?.foreign_s
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
        if let Some((share, seconds)) = load.share() {
            assert!(share >= 0.0 && seconds >= 0.05, "{share} {seconds}");
        }
    }
}
