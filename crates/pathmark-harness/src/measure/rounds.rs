//! Several rounds into one film: first some samples per pixel, then more. The film has the same bits as with all
//! samples at once.
//!
//! Each round has its own plan; the strategy is made once. Only rendering is timed. A round may end inside a block of
//! [`crate::film::SAMPLE_BLOCK`] samples, but the next round then renders the samples of that block again.

use super::run::{RoundTimes, RunTotals, Watch};
use super::{History, MergedShare, Outcome, Setup};
use crate::error::{InputError, Result};
use crate::film::{Film, ProgressiveFilm, Shard};
use crate::film_file::FilmKey;
use crate::settings::check_spp;
use std::ops::Range;

pub struct Rounds {
    setup: Setup,
    shard: Option<Shard>,
    totals: RunTotals,
    film: ProgressiveFilm,
}

impl Rounds {
    /// Starts with an empty film. The number of samples in the settings does not matter.
    pub fn new(setup: Setup) -> Result<Self> {
        Self::of(setup, None)
    }

    /// Starts with an empty film of one part of the image in the settings, or of the whole image.
    pub fn of(setup: Setup, shard: Option<Shard>) -> Result<Self> {
        setup.check_rounds()?;
        let (spec, spp) = (&setup.settings().spec, setup.settings().spp);
        if let Some(shard) = shard {
            shard.check(spec.width, spec.height, spp)?;
        }
        let film = ProgressiveFilm::new(spec.width, spec.height, shard.map_or(0, |shard| shard.samples(spp).start));
        Ok(Self { setup, shard, totals: RunTotals::new(), film })
    }

    /// Continues with a film of the same settings, and its counts as far as they are known, instead of the samples so
    /// far.
    pub fn adopt(&mut self, film: ProgressiveFilm, history: History) {
        self.film = film;
        self.totals.history = history;
    }

    /// Renders until there are `spp` samples per pixel. Does nothing if there are as many already: films do not shrink.
    pub fn extend_to(&mut self, spp: u32, watch: Watch<'_>) -> Result<RoundTimes> {
        self.extend(spp, |Self { setup, shard, totals, .. }, sections| {
            let plan = setup.plan_of(sections)?;
            let plan = match shard {
                Some(shard) => {
                    setup.check_size(shard.size_of_parts(&plan))?;
                    shard.part_of(&plan)
                }
                None => plan,
            };
            totals.round(setup, plan, sections, watch)
        })
    }

    /// The same by several processes: `render` lets them run the jobs of the given sections. Not for a part of an
    /// image.
    pub fn extend_by(
        &mut self,
        spp: u32,
        render: impl FnOnce(&Setup, &[Range<u32>]) -> Result<MergedShare>,
    ) -> Result<RoundTimes> {
        self.extend(spp, |Self { setup, totals, .. }, sections| {
            totals.assemble(setup, sections, render(setup, sections)?)
        })
    }

    /// Adds the missing samples; `round` returns the film of each section.
    fn extend(
        &mut self,
        spp: u32,
        round: impl FnOnce(&mut Self, &[Range<u32>]) -> Result<Vec<Film>>,
    ) -> Result<RoundTimes> {
        check_spp(spp, &self.setup.settings().spec.estimator, self.setup.spp_multiple())?;
        let sections = self.film.missing(spp);
        if sections.is_empty() {
            return Ok(RoundTimes::default());
        }
        let films = round(self, &sections)?;
        for (samples, film) in sections.into_iter().zip(films) {
            self.film.add(samples, film);
        }
        Ok(self.totals.last)
    }

    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    pub fn shard(&self) -> Option<Shard> {
        self.shard
    }

    pub fn pixels(&self) -> u64 {
        let spec = &self.setup.settings().spec;
        let all = u64::from(spec.width) * u64::from(spec.height);
        self.shard.map_or(all, |shard| shard.pixels(spec.width, spec.height))
    }

    /// Samples per pixel so far, those of earlier shards included.
    pub fn spp(&self) -> u32 {
        self.film.spp()
    }

    pub fn film(&self) -> Film {
        self.film.film()
    }

    /// The film with the data that further rounds need.
    pub fn growing(&self) -> &ProgressiveFilm {
        &self.film
    }

    pub fn history(&self) -> &History {
        &self.totals.history
    }

    pub fn film_key(&self) -> FilmKey {
        FilmKey { spp: self.spp(), ..self.setup.film_key() }
    }

    pub fn into_setup(self) -> Setup {
        self.setup
    }

    pub fn outcome(&self) -> Outcome {
        self.totals.outcome(&self.setup, self.spp(), self.film())
    }
}

impl Setup {
    /// Refuses settings that cannot be rendered in rounds.
    pub fn check_rounds(&self) -> Result<()> {
        if self.settings().adaptive {
            let problem = "cannot be rendered in rounds: the distribution of samples depends on their total number";
            return Err(InputError::new("adaptive", "true", problem).allowed("false in rounds and on curves").into());
        }
        let Some(clamp) = &self.settings().spec.clamp else { return Ok(()) };
        let problem = "needs all samples of a pixel at once, so it cannot be rendered in rounds";
        Err(InputError::new("clamp", clamp, problem).into())
    }
}
