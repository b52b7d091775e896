//! Statistics of measurements.

use super::Section;

pub(super) const SECTION: Section = Section { title: "Statistics of measurements", cases: &[] };
