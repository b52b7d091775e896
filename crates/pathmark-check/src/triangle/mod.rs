//! Cases about triangles, boxes and hierarchies.

mod areas;
mod arrangements;
mod contact;
mod edges;
mod hierarchies;
mod plane_distance;
#[cfg(test)]
mod plane_distance_tests;
mod planes;
mod seams;
mod single;
mod slabs;
mod slivers;
pub(super) mod unguarded;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Triangles, boxes and hierarchies",
    cases: &[
        edges::CASES,
        areas::CASES,
        plane_distance::CASES,
        slabs::CASES,
        hierarchies::CASES,
        arrangements::CASES,
        planes::CASES,
        contact::CASES,
        seams::CASES,
        slivers::CASES,
    ],
};
