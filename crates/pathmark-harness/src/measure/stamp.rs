//! The commit that the program was built from. The program itself states it, so that a commit rebuilds nothing else.

use std::sync::OnceLock;

/// The state of the sources at the time of the build.
#[derive(Debug, Clone, Copy)]
pub struct Stamp {
    /// The commit's hash, shortened.
    pub commit: &'static str,
    /// Whether sources differed from it.
    pub is_dirty: bool,
}

static STAMP: OnceLock<Stamp> = OnceLock::new();

impl Stamp {
    /// Makes it the stamp of this process's rows. Only the first call counts.
    pub fn set(self) {
        STAMP.get_or_init(|| self);
    }

    /// The stamp of this process's rows; an unknown commit if the program states none.
    pub fn of_program() -> Self {
        STAMP.get().copied().unwrap_or(Self { commit: "unknown", is_dirty: false })
    }
}
