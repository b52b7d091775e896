//! Several rounds into one film: first some samples a pixel, then more. The film is the one that all samples at once give, bit for bit.
//!
//! Each round is a plan of its own for the same strategy, which is made once. Only rendering is timed. Rounds that end inside a block of
//! [`SAMPLE_BLOCK`] samples are possible, but what they rendered of that block is rendered again by the next.

use super::run::{Account, RoundTimes, Watch};
use super::settings::check_spp;
use super::{Outcome, Setup};
use crate::error::{InputError, Result};
use crate::film::{Film, FilmKey, GrowingFilm, SAMPLE_BLOCK};

/// A render that can go on.
pub struct Rounds {
    setup: Setup,
    account: Account,
    film: GrowingFilm,
}

impl Rounds {
    /// Nothing rendered yet. The samples that the settings ask for do not matter.
    pub fn new(setup: Setup) -> Result<Self> {
        let spec = &setup.settings().spec;
        let film = GrowingFilm::new(spec.width, spec.height);
        Self::from_film(setup, film)
    }

    /// Goes on with a film of the same settings.
    pub fn from_film(setup: Setup, film: GrowingFilm) -> Result<Self> {
        if setup.settings().spec.subpixel_clamp {
            let problem = "needs all samples of a pixel at once, and so cannot be rendered in rounds";
            return Err(InputError::new("subpixel-clamp", "true", problem).into());
        }
        Ok(Self { setup, account: Account::new(), film })
    }

    /// Renders until there are `spp` samples a pixel. If there are as many already nothing happens: films do not shrink.
    pub fn extend_to(&mut self, spp: u32, watch: Watch<'_>) -> Result<RoundTimes> {
        check_spp(spp, &self.setup.settings().spec.estimator)?;
        let sections = self.film.missing(spp);
        if sections.is_empty() {
            return Ok(RoundTimes::default());
        }
        let plan = self.setup.plan_of(&sections)?;
        let films = self.account.round(&self.setup, plan, &sections, watch)?;
        for (samples, film) in sections.into_iter().zip(films) {
            self.film.add(samples, film);
        }
        Ok(self.account.last)
    }

    /// How many jobs a round to `spp` samples would have.
    pub fn jobs(&self, spp: u32) -> usize {
        self.film.missing(spp).len() * self.setup.jobs_per_section()
    }

    /// What was asked for.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Samples per pixel so far.
    pub fn spp(&self) -> u32 {
        self.film.spp()
    }

    /// Whether the next round can go on where the last one ended, without rendering samples again.
    pub fn is_at_block(&self) -> bool {
        self.spp().is_multiple_of(SAMPLE_BLOCK)
    }

    /// The sums of all samples so far.
    pub fn film(&self) -> Film {
        self.film.film()
    }

    /// The film with what is needed to go on.
    pub fn growing(&self) -> &GrowingFilm {
        &self.film
    }

    /// What the film so far is of.
    pub fn film_key(&self) -> FilmKey {
        FilmKey { spp: self.spp(), ..self.setup.film_key() }
    }

    /// Seconds of rendering so far, the putting together left out.
    pub fn makespan_s(&self) -> f64 {
        self.account.makespan_s
    }

    /// What all rounds came to.
    pub fn outcome(&self) -> Outcome {
        self.account.outcome(&self.setup, self.spp(), self.film())
    }
}
