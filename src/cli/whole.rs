//! How far several experiments have come together: one bar, in milliseconds of their estimate.

use super::progress::Talk;
use crate::experiment::{Plan, Progress};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Tells a `Talk` how far all experiments are, while each of them tells how far it is itself.
pub(super) struct Whole<'a> {
    talk: &'a Talk,
    total_s: f64,
    place: Mutex<Place>,
}

/// Where the work stands, in seconds of the estimate.
#[derive(Default)]
struct Place {
    plan: Plan,
    /// Before the experiment.
    start_s: f64,
    /// Before the step, the step's own, and its units.
    from_s: f64,
    step_s: f64,
    total: u64,
}

impl<'a> Whole<'a> {
    pub(super) fn new(talk: &'a Talk, plans: &[Plan]) -> Self {
        let total_s = plans.iter().map(Plan::seconds).sum();
        talk.begin("all experiments", milliseconds(total_s));
        Self { talk, total_s, place: Mutex::new(Place::default()) }
    }

    fn place(&self) -> MutexGuard<'_, Place> {
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next experiment begins.
    pub(super) fn enter(&self, plan: &Plan) {
        let mut place = self.place();
        let start_s = place.start_s + place.plan.seconds();
        *place = Place { plan: plan.clone(), start_s, from_s: start_s, ..Place::default() };
    }
}

fn milliseconds(seconds: f64) -> u64 {
    (seconds * 1e3) as u64
}

impl Progress for Whole<'_> {
    fn begin(&self, title: &str, total: u64) {
        let mut place = self.place();
        let cells_at = place.start_s + place.plan.references_s;
        (place.from_s, place.step_s) = if title == place.plan.name {
            (cells_at, place.plan.cells_s)
        } else {
            // Half of a reference; the halves of an experiment count alike.
            (place.from_s, place.plan.references_s / place.plan.halves.max(1) as f64)
        };
        place.total = total;
        let left_s = self.total_s - place.from_s;
        self.talk.step(title, &format!("about {:.0} min left of all experiments", (left_s / 60.0).ceil()));
        self.talk.advance(milliseconds(place.from_s));
    }

    fn advance(&self, done: u64) {
        let place = self.place();
        let share = done as f64 / place.total.max(1) as f64;
        self.talk.advance(milliseconds(place.from_s + place.step_s * share));
    }

    fn note(&self, text: &str) {
        self.talk.note(text);
    }

    /// A step ends; the bar goes on with the next one.
    fn end(&self) {
        let mut place = self.place();
        (place.from_s, place.step_s) = (place.from_s + place.step_s, 0.0);
    }
}

impl Drop for Whole<'_> {
    fn drop(&mut self) {
        self.talk.end();
    }
}
