//! Adaptive sampling, more samples for noisier pixels: `render --adaptive`, and `adaptive = [false, true]` in an
//! experiment.
//!
//! A pilot renders a few samples per pixel with a seed that no image can have, estimates the noise of each cell of a fixed
//! grid, and is discarded: renderers that reuse their pilot's samples are biased (Kirk and Arvo, "Unbiased Sampling
//! Techniques for Image Synthesis", 1991). The numbers of samples follow from scene and settings alone, so the checksum
//! does not depend on the schedule.

use super::run::{RunTotals, Watch};
use super::{Outcome, Settings, Setup};
use crate::error::{InputError, Result};
use crate::film::{Film, SampleGrid};
use crate::scene::SUBPIXELS;
use std::slice::from_ref;
use std::time::Instant;

/// Seeds from here on are for pilots: above the seeds of images, and far above those of references, which count from
/// 2^63.
const PILOT_SEEDS: u64 = 3 << 62;
/// Fewest samples per pixel of which some are left to distribute.
const FEWEST_SPP: u32 = 16;
/// Every pixel gets at least the mean number of samples divided by this: pixels that look quiet in the pilot may have
/// light that is seldom found.
const EVEN_PART: u32 = 8;
/// The pilot has the image's samples per pixel divided by this, but at least 8 and at most 64.
const PILOT_PART: u32 = 16;

impl Setup {
    pub(super) fn check_adaptive(&self) -> Result<()> {
        let Settings { adaptive, spp, rank_rule, .. } = self.settings();
        if !*adaptive {
            return Ok(());
        }
        if self.scene().is_none() {
            let problem = format!("does not apply to {}, which is a workload", self.name());
            return Err(InputError::new("adaptive", "true", problem).allowed("false").into());
        }
        if let Some(rule) = rank_rule {
            let problem =
                "cannot be combined with adaptive samples: it needs the same number of samples in every pixel";
            return Err(InputError::new("rank-rule", rule, problem).allowed("no rule").into());
        }
        if *spp >= FEWEST_SPP && spp.is_multiple_of(SUBPIXELS) {
            return Ok(());
        }
        let problem = "cannot be distributed by adaptive sampling";
        let allowed = format!("multiples of {SUBPIXELS} from {FEWEST_SPP}");
        Err(InputError::new("spp", spp.to_string(), problem).allowed(allowed).into())
    }

    /// Renders the requested mean number of samples, with more samples where a pilot found more noise.
    pub(super) fn run_adaptive(&self, watch: Watch<'_>) -> Result<Outcome> {
        let before = Instant::now();
        let grid = self.sample_grid()?;
        let pilot_s = before.elapsed().as_secs_f64();
        self.check_size(grid.plan_size(&self.decomposition))?;
        let plan = grid.plan(&self.decomposition);
        let mut totals = RunTotals::new();
        let spec = &self.settings().spec;
        let films = totals.round(self, plan, from_ref(&(0..grid.largest())), watch)?;
        let film = films.into_iter().next().unwrap_or_else(|| Film::new(spec.width, spec.height));
        let mut outcome = totals.outcome(self, self.settings().spp, film);
        outcome.pilot_s += pilot_s;
        Ok(outcome)
    }

    fn sample_grid(&self) -> Result<SampleGrid> {
        let Settings { spp, spec, .. } = self.settings();
        let pilot_spp = (spp / PILOT_PART).clamp(8, 64).next_multiple_of(SUBPIXELS);
        // Image seeds that differ in the highest bits alone share a pilot; no image uses its samples.
        let seed = PILOT_SEEDS | (spec.seed & !PILOT_SEEDS);
        let pilot = self.pilot(pilot_spp, seed)?.run(None)?;
        let least = (spp / EVEN_PART / SUBPIXELS * SUBPIXELS).max(SUBPIXELS);
        Ok(SampleGrid::neyman(&pilot.film, *spp, least, SUBPIXELS))
    }
}
