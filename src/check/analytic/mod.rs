//! Scenes with exact answers, each through every estimator that reaches it and the strategies in turn.
//!
//! No single one sees everything: furnaces are blind to geometry and visibility, a point light to how directions are chosen, lights over a
//! plane to what surfaces send on. A light off the middle of a sphere sees both.

pub(super) mod corridors;
mod fog;
mod form_factors;
mod furnaces;
mod glass;
mod metal;
mod planes;
mod point_lights;
mod spheres;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Scenes with exact answers",
    cases: &[
        furnaces::CASES,
        spheres::CASES,
        planes::CASES,
        point_lights::CASES,
        form_factors::CASES,
        corridors::CASES,
        glass::CASES,
        fog::CASES,
        metal::CASES,
    ],
};
