//! Frames, Fresnel, microfacets, lights.

mod frames;
mod fresnel;
mod glass;
mod materials;
pub(in crate::check) mod unguarded;
mod warps;

use super::Section;

pub(super) const SECTION: Section = Section {
    title: "Frames, Fresnel, microfacets, lights",
    cases: &[frames::CASES, warps::CASES, fresnel::CASES, glass::CASES],
};
