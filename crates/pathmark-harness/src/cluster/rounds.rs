//! Rounds by all ranks: until an accuracy is reached or time is up, with checkpoints.
//!
//! Rank 0 alone knows the film and the goal. Before each round it sends the range of samples to the others; they render
//! their share, and forget it. A run that was ended can therefore continue with another number of ranks.

use super::{Cluster, Tally, failed};
use crate::error::{Error, Result};
use crate::film::ProgressiveFilm;
use crate::lab::RankRule;
use crate::measure::{Extend, RoundTimes, Rounds, Setup};

/// Sent instead of a range of samples: no round follows.
const NO_MORE: [u64; 2] = [0; 2];

impl Cluster {
    /// Renders in rounds. On rank 0, calls `lead` with a function that extends its film; `lead` decides when to stop.
    /// The other ranks follow, and get `None`.
    pub fn render_in_rounds<T>(
        self,
        setup: Setup,
        rule: &RankRule,
        lead: impl FnOnce(Setup, Extend<'_>) -> Result<T>,
    ) -> Result<Option<(T, Tally)>> {
        let ranks = self.agreed(&setup, rule, "in rounds")?;
        let mut tally = Tally::new(&ranks.world);
        if !ranks.is_first() {
            ranks.follow(&setup, rule, &mut tally)?;
            ranks.world.end().map_err(failed)?;
            return Ok(None);
        }
        let mut is_broken = false;
        let led = lead(setup, &mut |rounds, spp| {
            is_broken = true;
            let times = ranks.lead_round(rounds, spp, rule, &mut tally)?;
            is_broken = false;
            Ok(times)
        });
        // After a failed round the others no longer listen; the launcher ends them.
        if !is_broken {
            ranks.tell(NO_MORE)?;
            ranks.world.end().map_err(failed)?;
        }
        led.map(|led| Some((led, tally)))
    }

    fn lead_round(&self, rounds: &mut Rounds, spp: u32, rule: &RankRule, tally: &mut Tally) -> Result<RoundTimes> {
        let from = rounds.spp();
        rounds.extend_by(spp, |setup, sections| {
            self.tell([u64::from(from), u64::from(spp)])?;
            let gathered = self.round(setup, rule, sections, tally)?;
            gathered.ok_or_else(|| Error::Check("rank 0 received no jobs from the other ranks".to_string()))
        })
    }

    fn follow(&self, setup: &Setup, rule: &RankRule, tally: &mut Tally) -> Result<()> {
        loop {
            let told = self.tell(NO_MORE)?;
            if told == NO_MORE {
                return Ok(());
            }
            let [from, to] = told.map(|samples| u32::try_from(samples).unwrap_or(u32::MAX));
            self.round(setup, rule, &ProgressiveFilm::missing_after(from, to), tally)?;
        }
    }

    /// Sends rank 0's `samples` to all ranks, and returns them.
    fn tell(&self, samples: [u64; 2]) -> Result<[u64; 2]> {
        let all = self.world.all_gather(&samples).map_err(failed)?;
        Ok(all.first_chunk().copied().unwrap_or(NO_MORE))
    }
}
