//! `pathmark inspect WHAT`: looks into one part of a run.

mod bounces;
mod jobs;
mod messages;
pub(super) mod path;
mod rays;

use crate::verbs::prelude::*;

#[derive(Subcommand)]
pub(crate) enum Inspect {
    /// Show one sample's path, bounce by bounce.
    Path(path::Arguments),
    /// Show the light and path lengths of an image by number of bounces.
    Bounces(bounces::Arguments),
    /// Time the search for the nearest hit, along the rays of paths.
    Rays(rays::Arguments),
    /// Show one run job by job, from the file of `render --trace`.
    Jobs(jobs::Arguments),
    /// Time MPI messages between the processes that mpiexec started.
    Messages(messages::Arguments),
}

impl Inspect {
    pub(super) fn run(self, lab: &Arc<Lab>, console: &Console) -> Result<()> {
        match self {
            Self::Path(arguments) => path::run(&arguments, lab),
            Self::Bounces(arguments) => bounces::run(&arguments, lab, console),
            Self::Rays(arguments) => rays::run(&arguments, lab, console),
            Self::Jobs(arguments) => jobs::run(&arguments, console),
            Self::Messages(arguments) => messages::run(&arguments),
        }
    }
}
