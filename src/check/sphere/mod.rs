//! Ray against sphere, and where rays start.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Ray against sphere, and where rays start", cases: &[] };
