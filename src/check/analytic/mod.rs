//! Scenes with exact answers.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Scenes with exact answers", cases: &[] };
