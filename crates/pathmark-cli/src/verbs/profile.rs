//! The options that choose the size at which an experiment is run.

use crate::experiment::Profile;
use clap::Args;

/// At most one of them is given.
#[derive(Args)]
#[group(multiple = false)]
pub(super) struct Choice {
    /// Small images, minutes (the default)
    #[arg(long)]
    quick: bool,
    /// Larger images, up to hours
    #[arg(long)]
    full: bool,
    /// The sizes and parameters of the reports; all experiments take an hour
    #[arg(long)]
    reports: bool,
}

impl Choice {
    pub(super) fn profile(&self) -> Profile {
        match (self.full, self.reports) {
            (true, _) => Profile::Full,
            (_, true) => Profile::Reports,
            _ => Profile::Quick,
        }
    }
}
