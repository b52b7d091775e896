//! Triangles, boxes and hierarchies.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Triangles, boxes and hierarchies", cases: &[] };
