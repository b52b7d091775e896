//! Hard cases: inputs on which careless numerics fail, as a table that both `pathmark selftest` and the tests run.
//!
//! Each case has the identifier of the catalogue from which its inputs come (a letter for the section and a number)
//! and states the expected result. The expected value is a closed form, a value computed with more digits, the result
//! of another method, or a property. It is never an earlier result of this program.
//!
//! ```
//! use pathmark_check::{Effort, find};
//!
//! let Some(case) = find("S11") else { return }; // a ray that touches a sphere
//! let outcome = case.run(Effort::Quick);
//! assert!(outcome.passed(), "{outcome:?}");
//! ```
//!
//! # Adding one
//!
//! Add a line to the table of its section, with the function that runs the test:
//!
//! ```
//! use pathmark_check::{Case, Trials};
//!
//! const CASE: Case = Case { id: "S17", tries: "a ray from the centre", run: from_the_centre };
//!
//! fn from_the_centre(trials: &mut Trials) {
//!     trials.close("any direction", 2.0, 2.0, 1e-15);
//! }
//! ```

mod analytic;
pub mod bare_scene;
mod double_double;
pub mod exact;
#[cfg(test)]
mod fixed_point_tests;
pub mod guards;
pub mod materials;
mod meshes;
mod path;
mod quadrature;
mod random;
mod random_numbers;
mod refusals;
mod rendering;
mod run;
mod shading;
mod sphere;
pub mod stage;
mod statistics;
mod trials;
mod triangle;

pub use run::run;
pub use trials::{Effort, Outcome, Trial, Trials};

use cases_file::CaseRow;
use pathmark_harness::{
    analysis, cases_file, effect, error, estimator, experiment, film, guard_prices, image_io, kernel, lab, material,
    math, measure, metric, sampling, scene, simd, strategy,
};
use std::panic::{AssertUnwindSafe, catch_unwind};
use trials::critical;

/// The rounding unit.
const U: f64 = f64::EPSILON / 2.0;

/// The sections of the catalogue that the table contains, in catalogue order.
pub static SECTIONS: &[Section] = &[
    sphere::SECTION,
    triangle::SECTION,
    shading::SECTION,
    path::SECTION,
    random_numbers::SECTION,
    statistics::SECTION,
    analytic::SECTION,
];

/// The cases about one subject.
pub struct Section {
    /// The subject, for headings.
    pub title: &'static str,
    pub cases: &'static [Case],
}

/// A hard case.
pub struct Case {
    /// Name in the catalogue: a letter for the section and a number.
    pub id: &'static str,
    /// Short description of the test.
    pub tries: &'static str,
    /// Runs the test for everything that it applies to: formulas, precisions, kernels, estimators, strategies.
    pub run: fn(&mut Trials),
}

/// A line of the table. [`Case`] describes the fields.
const fn case(id: &'static str, tries: &'static str, run: fn(&mut Trials)) -> Case {
    Case { id, tries, run }
}

impl Case {
    /// Runs the test. A panic becomes a failed trial with the panic's message.
    pub fn run(&self, effort: Effort) -> Outcome {
        let mut trials = Trials::new(effort);
        if let Err(payload) = catch_unwind(AssertUnwindSafe(|| (self.run)(&mut trials))) {
            let words = payload.downcast_ref::<&str>().map(ToString::to_string);
            let words = words.or_else(|| payload.downcast_ref::<String>().cloned());
            trials.holds("whole case", "no panic", words.unwrap_or_else(|| "a panic without words".to_string()), false);
        }
        trials.outcome()
    }
}

/// All cases, section by section.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    SECTIONS.iter().flat_map(|section| section.cases)
}

/// The case with this name.
pub fn find(id: &str) -> Option<&'static Case> {
    cases().find(|case| case.id == id)
}

/// The row of a case in `check/cases.csv`. It shows the first trial that failed, or else the last.
pub fn case_row(case: &Case, outcome: &Outcome) -> CaseRow {
    let shown = outcome.failures().next().or(outcome.trials.last());
    let of = |part: fn(&Trial) -> String| shown.map(part).unwrap_or_default();
    CaseRow {
        id: case.id.to_string(),
        tries: case.tries.to_string(),
        pass: outcome.passed(),
        trials: outcome.trials.len(),
        failed: outcome.failures().count(),
        variant: of(|trial| trial.variant.clone()),
        expected: of(|trial| trial.expected.clone()),
        found: of(|trial| trial.found.clone()),
        skipped: outcome.skipped.join("; "),
    }
}
