//! Progress of several experiments together: one bar, in milliseconds of their estimate.

use crate::console::Console;
use crate::experiment::{Plan, Progress};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// The progress of all experiments for a `Console`, from the progress of each experiment.
pub(super) struct OverallProgress<'a> {
    console: &'a Console,
    total_s: f64,
    place: Mutex<Place>,
    pace: Mutex<Pace>,
}

/// The time that work took, beside its estimate.
struct Pace {
    at_s: f64,
    at: Instant,
    estimated_s: f64,
    taken_s: f64,
}

impl Pace {
    /// Records that the work has reached a second of the estimate.
    fn watch(&mut self, at_s: f64) {
        let (estimated_s, taken_s) = (at_s - self.at_s, self.at.elapsed().as_secs_f64());
        // Rows that an earlier run made take no time and say nothing about the pace.
        if taken_s > 0.01 * estimated_s {
            self.estimated_s += estimated_s;
            self.taken_s += taken_s;
        }
        (self.at_s, self.at) = (at_s, Instant::now());
    }

    /// Seconds taken for each second of the estimate.
    fn factor(&self) -> f64 {
        if self.estimated_s > 0.0 { self.taken_s / self.estimated_s } else { 1.0 }
    }
}

/// The position of the work, in seconds of the estimate.
#[derive(Default)]
struct Place {
    plan: Plan,
    /// Start of the experiment.
    start_s: f64,
    /// Start of the step, its seconds, and its units.
    from_s: f64,
    step_s: f64,
    total: u64,
}

impl<'a> OverallProgress<'a> {
    pub(super) fn new(console: &'a Console, plans: &[Plan]) -> Self {
        let total_s = plans.iter().map(Plan::seconds).sum();
        console.begin_steps("all experiments", milliseconds(total_s));
        let pace = Pace { at_s: 0.0, at: Instant::now(), estimated_s: 0.0, taken_s: 0.0 };
        Self { console, total_s, place: Mutex::new(Place::default()), pace: Mutex::new(pace) }
    }

    /// Records that the work has reached a second of the estimate; returns the time left in words.
    fn reach(&self, at_s: f64) -> String {
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        pace.watch(at_s);
        let left = format!("about {:.0} min", (pace.factor() * (self.total_s - at_s).max(0.0) / 60.0).ceil());
        self.console.left(&left);
        self.console.advance(milliseconds(at_s));
        left
    }

    fn place(&self) -> MutexGuard<'_, Place> {
        self.place.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins the next experiment.
    pub(super) fn enter(&self, plan: &Plan) {
        let mut place = self.place();
        let start_s = place.start_s + place.plan.seconds();
        *place = Place { plan: plan.clone(), start_s, from_s: start_s, ..Place::default() };
    }
}

fn milliseconds(seconds: f64) -> u64 {
    (seconds * 1e3) as u64
}

impl Progress for OverallProgress<'_> {
    fn begin(&self, title: &str, total: u64) {
        let mut place = self.place();
        let cells_at = place.start_s + place.plan.references_s;
        (place.from_s, place.step_s) = if title == place.plan.name {
            (cells_at, place.plan.cells_s)
        } else {
            // Half of a reference; all halves of an experiment count equally.
            (place.from_s, place.plan.references_s / place.plan.halves.max(1) as f64)
        };
        place.total = total;
        self.console.step(title, &self.reach(place.from_s));
    }

    fn advance(&self, done: u64) {
        let place = self.place();
        let share = done as f64 / place.total.max(1) as f64;
        self.reach(place.from_s + place.step_s * share);
    }

    fn note(&self, text: &str) {
        self.console.note(text);
    }

    /// Ends a step; the bar continues with the next one.
    fn end(&self) {
        let mut place = self.place();
        (place.from_s, place.step_s) = (place.from_s + place.step_s, 0.0);
    }
}

impl Drop for OverallProgress<'_> {
    fn drop(&mut self) {
        self.console.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn rows_that_are_there_do_not_change_the_pace() {
        let at = Instant::now().checked_sub(Duration::from_secs(20)).unwrap();
        let mut pace = Pace { at_s: 0.0, at, estimated_s: 0.0, taken_s: 0.0 };
        pace.watch(10.0);
        let slow = pace.factor();
        assert!((2.0..2.5).contains(&slow), "{slow}");
        pace.watch(1e6);
        assert_eq!(pace.factor(), slow);
    }
}
