//! Several rounds into one film: first some samples a pixel, then more. The film is the one that all samples at once give, bit for bit.
//!
//! Each round is a plan of its own for the same strategy, which is made once. Only rendering is timed. Rounds that end inside a block of
//! [`crate::film::SAMPLE_BLOCK`] samples are possible, but what they rendered of that block is rendered again by the next.

use super::run::{Account, RoundTimes, Watch};
use super::settings::check_spp;
use super::{Gathered, History, Outcome, Setup};
use crate::error::{InputError, Result};
use crate::film::{Film, GrowingFilm, Shard};
use crate::film_file::FilmKey;
use std::ops::Range;

/// A render that can go on.
pub struct Rounds {
    setup: Setup,
    shard: Option<Shard>,
    account: Account,
    film: GrowingFilm,
}

impl Rounds {
    /// Nothing rendered yet. The samples that the settings ask for do not matter.
    pub fn new(setup: Setup) -> Result<Self> {
        Self::of(setup, None)
    }

    /// Nothing rendered yet of one part of the image that the settings ask for, or of all of it.
    pub fn of(setup: Setup, shard: Option<Shard>) -> Result<Self> {
        setup.check_rounds()?;
        let (spec, spp) = (&setup.settings().spec, setup.settings().spp);
        if let Some(shard) = shard {
            shard.check(spec.width, spec.height, spp)?;
        }
        let film = GrowingFilm::new(spec.width, spec.height, shard.map_or(0, |shard| shard.samples(spp).start));
        Ok(Self { setup, shard, account: Account::new(), film })
    }

    /// Goes on with a film of the same settings, and what happened in it as far as that is known, instead of what was rendered so far.
    pub fn adopt(&mut self, film: GrowingFilm, history: History) {
        self.film = film;
        self.account.history = history;
    }

    /// Renders until there are `spp` samples a pixel. If there are as many already nothing happens: films do not shrink.
    pub fn extend_to(&mut self, spp: u32, watch: Watch<'_>) -> Result<RoundTimes> {
        self.extend(spp, |Self { setup, shard, account, .. }, sections| {
            let plan = setup.plan_of(sections)?;
            let plan = shard.map_or_else(|| plan.clone(), |shard| shard.part_of(&plan));
            setup.check_jobs(plan.len())?;
            account.round(setup, plan, sections, watch)
        })
    }

    /// The same by several processes: `render` has them do the jobs of the sections that it is given. Not for a part of an image.
    pub fn extend_by(
        &mut self,
        spp: u32,
        render: impl FnOnce(&Setup, &[Range<u32>]) -> Result<Gathered>,
    ) -> Result<RoundTimes> {
        self.extend(spp, |Self { setup, account, .. }, sections| {
            account.assemble(setup, sections, render(setup, sections)?)
        })
    }

    /// Adds what is missing; `round` gives the film of each section.
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
        Ok(self.account.last)
    }

    /// What was asked for.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Which part of the image it is, if it is not the whole.
    pub fn shard(&self) -> Option<Shard> {
        self.shard
    }

    /// How many pixels are rendered.
    pub fn pixels(&self) -> u64 {
        let spec = &self.setup.settings().spec;
        let all = u64::from(spec.width) * u64::from(spec.height);
        self.shard.map_or(all, |shard| shard.pixels(spec.width, spec.height))
    }

    /// Samples per pixel so far, those of earlier shards included.
    pub fn spp(&self) -> u32 {
        self.film.spp()
    }

    /// The sums of all samples so far.
    pub fn film(&self) -> Film {
        self.film.film()
    }

    /// The film with what is needed to go on.
    pub fn growing(&self) -> &GrowingFilm {
        &self.film
    }

    /// What happened on the paths of the film.
    pub fn history(&self) -> &History {
        &self.account.history
    }

    /// What the film so far is of.
    pub fn film_key(&self) -> FilmKey {
        FilmKey { spp: self.spp(), ..self.setup.film_key() }
    }

    /// What was asked for, when there are no more rounds.
    pub fn into_setup(self) -> Setup {
        self.setup
    }

    /// What all rounds came to.
    pub fn outcome(&self) -> Outcome {
        self.account.outcome(&self.setup, self.spp(), self.film())
    }
}

impl Setup {
    /// Refuses settings that cannot be rendered in rounds.
    pub fn check_rounds(&self) -> Result<()> {
        if self.settings().adaptive {
            let problem =
                "depends on the number of samples, so a render with more of them does not go on from one with fewer";
            return Err(InputError::new("adaptive", "true", problem).allowed("false in rounds and on curves").into());
        }
        let Some(clamp) = &self.settings().spec.clamp else { return Ok(()) };
        let problem = "needs all samples of a pixel at once, and so cannot be rendered in rounds";
        Err(InputError::new("clamp", clamp, problem).into())
    }
}
