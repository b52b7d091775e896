//! Paths, sums and images.

mod invalid_samples;

use super::Section;

pub(super) const SECTION: Section = Section { title: "Paths, sums and images", cases: &[invalid_samples::CASES] };
