//! Scenes with exact answers: each is rendered by every estimator that reaches its light, and by the strategies in
//! turn.
//!
//! No single scene checks everything. Furnaces are blind to geometry and visibility, a point light is blind to
//! direction sampling, and lights over a plane are blind to light that surfaces pass on. A light off the centre of a
//! sphere checks both direct and indirect light.

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
