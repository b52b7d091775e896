//! Frames, Fresnel, microfacets, lights.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Frames, Fresnel, microfacets, lights", cases: &[] };
