//! Cases about frames, Fresnel, microfacets and lights.

mod agreement;
mod balance;
mod cones;
mod degenerate;
mod directions;
mod facets;
mod frames;
pub(super) mod fresnel;
mod glass;
mod lights;
mod report_b;
mod shares;
mod smooth;
mod targets;
pub(crate) mod unguarded;
mod warps;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Frames, Fresnel, microfacets, lights",
    cases: &[
        frames::CASES,
        warps::CASES,
        fresnel::CASES,
        glass::CASES,
        facets::CASES,
        smooth::CASES,
        report_b::CASES,
        degenerate::CASES,
        balance::CASES,
        cones::CASES,
        shares::CASES,
        agreement::CASES,
        lights::CASES,
        directions::CASES,
    ],
};
