//! Chapters of the report page, in their order.

use serde::Deserialize;

/// A chapter of the report page. Each experiment names its chapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Chapter {
    /// Error against time.
    Accuracy,
    /// Schedules, threads and overhead.
    Scheduling,
    /// Guards, and inputs on which simpler programs fail.
    HardInputs,
    /// Effects that a scene uses, and their price.
    Effects,
    /// Experiments that name no chapter.
    #[default]
    Others,
}

impl Chapter {
    /// All chapters, in the order of the page.
    pub const ALL: [Self; 5] = [Self::Accuracy, Self::Scheduling, Self::HardInputs, Self::Effects, Self::Others];

    /// The anchor at which links to the chapter point.
    pub fn anchor(self) -> &'static str {
        match self {
            Self::Accuracy => "chapter-accuracy",
            Self::Scheduling => "chapter-scheduling",
            Self::HardInputs => "chapter-hard-inputs",
            Self::Effects => "chapter-effects",
            Self::Others => "chapter-others",
        }
    }

    /// Its heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Accuracy => "What accuracy costs in time",
            Self::Scheduling => "Who runs what when: scheduling",
            Self::HardInputs => "What stays right on hard inputs",
            Self::Effects => "Effects only where a scene calls for them",
            Self::Others => "Other experiments",
        }
    }
}
