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
mod outlines;
mod planes;

use super::{Section, case};

pub(super) const SECTION: Section = Section {
    title: "Scenes with exact answers",
    cases: &[
        case("A1", "a closed sphere that glows: Le/(1 - rho)", furnaces::glowing_wall),
        case("A2", "smallpt's box in thermal equilibrium: 1 everywhere", furnaces::equilibrium),
        case("A22", "smallpt's box has smallpt's mean", furnaces::smallpt_mean),
        case("A3", "a point light in the middle of a sphere", furnaces::light_in_the_middle),
        case("A4", "an integrating sphere with a black source", furnaces::integrating_sphere),
        case("A5", "a point light off the middle of a sphere", furnaces::light_off_the_middle),
        case("A6", "a spherical light over a plane", planes::sphere_over_a_plane),
        case("A8", "a square light over a plane", planes::square_over_a_plane),
        case("A11", "parallel plates", planes::parallel_plates),
        case("A12", "a ball under half a sky", planes::ball_under_half_a_sky),
        case("A7", "point lights over a plane: rho I cos/(pi d^2)", planes::light_over_a_plane),
        case("A9", "coaxial disks", form_factors::coaxial_disks),
        case("A10", "faces of a cube", form_factors::faces_of_a_cube),
        case("A13", "chains of mirrors: rho^k", corridors::chains),
        case("A14", "a lossless slab, straight through", glass::lossless),
        case("A15", "a slab that absorbs", glass::absorbing),
        case("A16", "a lossless slab, at a slant", glass::slanted),
        case("A17", "light through fog that absorbs: exp(-tau)", fog::absorption),
        case("A18", "fog that absorbs and glows: 1 - exp(-tau)", fog::emission),
        case("A19", "the mean way through a ball that absorbs", fog::ball),
        case("A20", "fog that scatters, in a furnace", fog::furnace),
        case("A21", "rough metal under an even sky", planes::metal_under_a_sky),
        case("A23", "a ball off the axis is an ellipse", outlines::ellipses),
    ],
};
