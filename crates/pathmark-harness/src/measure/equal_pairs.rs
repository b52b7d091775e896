//! Pairs of equal runs: their ratios differ from 1 only by what disturbs this machine.

use super::{Settings, Setup};
use crate::error::Result;
use crate::kernel::Spec;
use crate::lab::Lab;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Samples per pixel and size of a run: some 5 ms of work on two processors, since the speed of a machine drifts.
const SPP: u32 = 4;
const SIZE: [u32; 2] = [128, 96];

/// The pairs of one process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EqualPairs {
    /// The makespan of one run over that of the run beside it. The run that comes first is the divisor in every second
    /// pair, so that a steady drift cancels out.
    pub ratios: Vec<f64>,
    /// Seconds that all pairs took, with everything between the runs.
    pub seconds: f64,
}

/// Times pairs of equal runs of the built-in scene with the default schedule: at least one pair, and no new one after
/// so many seconds.
pub fn equal_pairs(lab: &Lab, seconds: f64) -> Result<EqualPairs> {
    let [width, height] = SIZE;
    let settings = Settings { spp: SPP, spec: Spec { width, height, ..Spec::default() }, ..Settings::default() };
    let setup = lab.prepare(settings)?;
    // The first run builds the kernel and meets cold caches.
    run(&setup)?;
    let (begun, time) = (Instant::now(), Duration::from_secs_f64(seconds));
    let mut ratios = Vec::new();
    loop {
        let [first, second] = [run(&setup)?, run(&setup)?];
        ratios.push(if ratios.len().is_multiple_of(2) { first / second } else { second / first });
        if begun.elapsed() >= time {
            return Ok(EqualPairs { ratios, seconds: begun.elapsed().as_secs_f64() });
        }
    }
}

fn run(setup: &Setup) -> Result<f64> {
    Ok(setup.run(None)?.makespan_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_always_a_pair() {
        let pairs = equal_pairs(&Lab::built_in(), 0.0).unwrap();
        assert!(pairs.ratios.len() == 1 && pairs.ratios[0] > 0.0 && pairs.seconds > 0.0, "{pairs:?}");
    }
}
