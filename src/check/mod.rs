//! Hard cases: inputs on which careless numerics go wrong, as a table that both `pathmark check` and the tests run.
//!
//! Each case has the identifier of the catalogue from which its inputs come (a letter for the section and a number) and says what must
//! come out. What is expected is a closed form, a value computed with more digits, another method or a property; never what this
//! program gave before.
//!
//! ```
//! use pathmark::check::{Effort, find};
//!
//! let Some(case) = find("S11") else { return }; // a ray that touches a sphere
//! let outcome = case.run(Effort::Quick);
//! assert!(outcome.passed(), "{outcome:?}");
//! ```
//!
//! # Adding one
//!
//! A line in the `CASES` of the file that fits, with the function that tries it:
//!
//! ```
//! use pathmark::check::{Case, Trials};
//!
//! const CASE: Case = Case { id: "S17", tries: "a ray from the centre", run: from_the_centre };
//!
//! fn from_the_centre(trials: &mut Trials) {
//!     trials.close("any direction", 2.0, 2.0, 1e-15);
//! }
//! ```

mod analytic;
pub mod bare_scene;
pub mod cases_file;
mod double_double;
pub mod exact;
#[cfg(test)]
mod fixed_point;
pub mod guards;
mod image_mean;
mod level;
pub mod materials;
mod meshes;
mod path;
mod quadrature;
mod random;
mod random_numbers;
mod refusals;
mod rendering;
mod run;
mod samplers;
mod shading;
mod sphere;
pub mod stage;
mod statistics;
mod trials;
mod triangle;

pub use run::run;
pub use trials::{Effort, Outcome, Trial, Trials};

use std::panic::{AssertUnwindSafe, catch_unwind};

/// The sections of the catalogue that the table has, in its order.
pub static SECTIONS: &[Section] = &[
    sphere::SECTION,
    triangle::SECTION,
    shading::SECTION,
    path::SECTION,
    random_numbers::SECTION,
    statistics::SECTION,
    analytic::SECTION,
];

/// What is tried about one subject.
pub struct Section {
    /// What it is about, for headings.
    pub title: &'static str,
    /// Its cases, file by file.
    pub cases: &'static [&'static [Case]],
}

/// A hard case.
pub struct Case {
    /// Its name in the catalogue: a letter for the section and a number.
    pub id: &'static str,
    /// What is tried, in a few words.
    pub tries: &'static str,
    /// Tries it, for all that it applies to: formulas, precisions, kernels, estimators, strategies.
    pub run: fn(&mut Trials),
}

impl Case {
    /// Tries it. A panic is a trial that failed, with the panic's words.
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
    SECTIONS.iter().flat_map(|section| section.cases.iter().copied().flatten())
}

/// The case of that name.
pub fn find(id: &str) -> Option<&'static Case> {
    cases().find(|case| case.id == id)
}
