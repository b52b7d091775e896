//! Paths, sums and images.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Paths, sums and images", cases: &[] };
