//! Random numbers.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Random numbers", cases: &[] };
