//! Goals of a render: a number of samples, an accuracy, or a time limit. docs/notes/errors.md says when a look at the accuracy
//! stops a render ([`CONFIDENCE`], [`crate::film::Noise`]).
//!
//! Two facts prevent a stop by luck. The looks are few, and their estimates share most of their samples. Heavy tails, if
//! they make a sample variance too small by luck, make the image's error small by the same luck.
//!
//! Looks follow from the film alone, so a render that was stopped in between ends in the same way. Between looks, a
//! time limit or a checkpoint may divide the samples into steps.

use super::run::{RoundTimes, Watch};
use super::{Outcome, Rounds, Setup, Warning};
use crate::analysis::z_test::normal_quantile;
use crate::error::{InputError, Result};
use crate::film::{FEWEST_PIXELS, SAMPLE_BLOCK};
use crate::settings::{LARGEST_SPP, Seconds, check_positive};

/// Confidence with which the RMSE of a render must be below its target.
pub const CONFIDENCE: f64 = 0.95;
/// If time is nearly up, rounds that add less than this share of the samples so far are skipped.
const LEAST_GAIN: f64 = 0.02;

/// When to stop: at the first of these that is reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    pub spp: Option<u32>,
    /// RMSE in linear radiance.
    pub target_error: Option<f64>,
    pub time_limit_s: Option<f64>,
    /// Seconds of rendering after which a round should end, so that the caller gets control.
    pub pause_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Seconds of rendering, those of earlier processes included.
    pub rendering_s: f64,
    pub look: u32,
}

/// A function that renders up to so many samples per pixel: [`Rounds::extend_to`], or several processes.
pub type Extend<'a> = &'a mut dyn FnMut(&mut Rounds, u32) -> Result<RoundTimes>;

pub type Between<'a> = &'a mut dyn FnMut(&Rounds, Position) -> Result<()>;

impl Goal {
    pub fn check(&self, rounds: &Rounds) -> Result<()> {
        for (field, value) in [("target-error", self.target_error), ("time-limit", self.time_limit_s)] {
            value.map_or(Ok(()), |value| check_positive(field, value))?;
        }
        let spec = &rounds.setup().settings().spec;
        let pixels = spec.width as usize * spec.height as usize;
        if self.target_error.is_some() && pixels < FEWEST_PIXELS {
            let problem = format!("has too few pixels to estimate the noise; at least {FEWEST_PIXELS} are needed");
            return Err(InputError::new("size", format!("{}x{}", spec.width, spec.height), problem).into());
        }
        if let Some(spp) = self.spp.filter(|spp| *spp < rounds.spp()) {
            let problem = format!("is less than the {} samples per pixel of the checkpoint", rounds.spp());
            return Err(InputError::new("spp", spp.to_string(), problem).into());
        }
        Ok(())
    }

    /// Samples at the next look; `None` if the goal is reached.
    fn next_look(&self, rounds: &Rounds) -> Result<Option<u32>> {
        let (spp, multiple) = (rounds.spp(), rounds.setup().spp_multiple());
        let Some(target) = self.target_error else {
            let end = self.spp.unwrap_or(LARGEST_SPP / multiple * multiple);
            return Ok((spp < end).then_some(end));
        };
        let first = SAMPLE_BLOCK.next_multiple_of(multiple);
        let Some(noise) = rounds.film().noise().filter(|_| spp >= first) else { return Ok(Some(first)) };
        let bound = noise.bound(normal_quantile(CONFIDENCE).unwrap_or_default());
        if bound <= target * target {
            return Ok(None);
        }
        let wanted = f64::from(spp) * bound / (target * target);
        if wanted > f64::from(LARGEST_SPP) {
            let problem = format!("needs about {wanted:.0} samples per pixel");
            return Err(InputError::new("target-error", target.to_string(), problem)
                .allowed(format!("errors that {LARGEST_SPP} samples per pixel can reach"))
                .into());
        }
        let wanted = (wanted.ceil() as u32).next_multiple_of(multiple);
        Ok(Some(wanted.clamp(spp + multiple, 2 * spp)))
    }

    /// Samples at the end of the next round, on the way to a look; `None` if there is no time for one.
    fn next_step(&self, rounds: &Rounds, rendering_s: f64, last: &RoundTimes, look: u32) -> Option<u32> {
        let (spp, multiple) = (rounds.spp(), rounds.setup().spp_multiple());
        if self.time_limit_s.is_none() && self.pause_s.is_none() {
            return Some(look);
        }
        if last.paths == 0 {
            // The time of a sample is unknown: as few as possible if there is a time limit.
            let few = if self.time_limit_s.is_some() { multiple } else { SAMPLE_BLOCK.next_multiple_of(multiple) };
            let is_first = spp == 0 || self.time_limit_s.is_none_or(|limit_s| rendering_s < limit_s);
            return is_first.then_some(look.min(spp + few));
        }
        let samples_s = rounds.pixels() as f64 * last.makespan_s / last.paths as f64;
        // Samples of an unfinished block are rendered again.
        let block = spp / SAMPLE_BLOCK * SAMPLE_BLOCK;
        let fits = |seconds: f64| {
            let samples = (seconds / samples_s).clamp(0.0, f64::from(LARGEST_SPP)) as u32;
            block.saturating_add(samples).min(look) / multiple * multiple
        };
        // The time of the last round says little about a much longer one; but a block should rather be rendered once
        // than twice.
        let mut end = look.min(spp.saturating_mul(2).max(SAMPLE_BLOCK));
        if let Some(pause_s) = self.pause_s {
            end = end.min(fits(pause_s).max(spp + multiple));
        }
        if let Some(limit_s) = self.time_limit_s {
            let fitting = fits(limit_s - rendering_s);
            if f64::from(fitting) < f64::from(spp) * (1.0 + LEAST_GAIN) && fitting < look {
                return None;
            }
            end = end.min(fitting);
        }
        // Before the look, rounds end with a block if possible, so that nothing is rendered twice.
        let aligned = end / SAMPLE_BLOCK.max(multiple) * SAMPLE_BLOCK.max(multiple);
        let end = if end < look && aligned > spp { aligned } else { end };
        (end > spp).then_some(end)
    }

    /// Renders until the goal is reached, by `extend`. `before` is the progress of earlier processes, if a checkpoint
    /// knows it. Warns if time was up before the target was reached.
    pub fn pursue(
        &self,
        rounds: &mut Rounds,
        before: Option<Position>,
        extend: Extend<'_>,
        between: Between<'_>,
    ) -> Result<Option<Warning>> {
        let mut last = RoundTimes::default();
        let mut rendering_s = before.map_or(0.0, |before| before.rendering_s);
        let is_ahead = |look: &u32| *look > rounds.spp() && self.spp.is_none_or(|spp| *look <= spp);
        let mut look = before.map(|before| before.look).filter(is_ahead);
        loop {
            let Some(end) = look.map_or_else(|| self.next_look(rounds), |look| Ok(Some(look)))? else {
                return Ok(None);
            };
            while rounds.spp() < end {
                let Some(step) = self.next_step(rounds, rendering_s, &last, end) else {
                    return Ok(self.target_error.map(|_| Warning::TargetMissed));
                };
                last = extend(rounds, step)?;
                rendering_s += last.makespan_s;
                between(rounds, Position { rendering_s, look: end })?;
            }
            look = None;
        }
    }
}

impl Setup {
    /// Renders until time is up, or the samples of the settings are reached.
    pub(super) fn run_for(&self, limit: Seconds, watch: Watch<'_>) -> Result<Outcome> {
        // The copy below shares a kernel that has been built.
        self.build()?;
        let mut rounds = Rounds::new(self.clone())?;
        let spp = Some(self.settings().spp);
        let goal = Goal { spp, target_error: None, time_limit_s: Some(limit.into()), pause_s: None };
        goal.pursue(&mut rounds, None, &mut |rounds, spp| rounds.extend_to(spp, watch), &mut |_, _| Ok(()))?;
        Ok(rounds.outcome())
    }
}
