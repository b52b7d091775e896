//! Cases about ray-sphere intersection and the starts of rays.

pub(super) mod bulk;
mod chains;
pub(super) mod exact;
#[cfg(test)]
mod exact_tests;
mod formulas;
mod known_rays;
mod leaks;
mod refused;
mod scale;
mod short_ways;
mod smallpt_box;
mod starts;
mod tangents;
mod ties;
pub(super) mod unguarded;
mod walk;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Ray against sphere, and where rays start",
    cases: &[
        known_rays::CASES,
        tangents::CASES,
        refused::CASES,
        bulk::CASES,
        short_ways::CASES,
        scale::CASES,
        leaks::CASES,
        starts::CASES,
        ties::CASES,
        smallpt_box::CASES,
        chains::CASES,
    ],
};
