//! `--output printed-progress`: as `row-progress`, but the worker also prints a progress bar while it holds the lock, as report B's program
//! does (docs/reports.md). Wrong on purpose: all workers wait while one of them prints.
//!
//! Cost: one lock, a text of some 80 characters and one call of the system for each row of each piece. The bars go to the
//! system's null device, so a terminal's own cost is not in them, and the output of the program stays readable.

use super::Entry;
use super::row_progress::RowProgress;
use crate::error::Error;
use std::fs::OpenOptions;

/// Accepts every text and keeps none.
const NULL_DEVICE: &str = "/dev/null";

pub(super) const ENTRY: Entry = Entry {
    name: "printed-progress",
    about: "wrong on purpose: like row-progress, plus a progress bar printed behind the lock, to the null device (report B)",
    new: |delivery| {
        let opened = OpenOptions::new().write(true).open(NULL_DEVICE);
        let shown = opened.map_err(|e| Error::system("opening", NULL_DEVICE, e))?;
        Ok(Box::new(RowProgress::new(delivery, Some(shown))?))
    },
};
