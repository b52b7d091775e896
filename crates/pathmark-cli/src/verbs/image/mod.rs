//! `pathmark image WHAT`: files of images and films.

mod compare;
mod convert;
pub(super) mod picture;
mod reference;

use crate::console::Console;
use crate::error::Result;
use crate::lab::Lab;
use clap::Subcommand;
use std::sync::Arc;

#[derive(Subcommand)]
pub(crate) enum Image {
    /// Measure the error of an image against one reference, or against two to exclude their noise.
    Compare(compare::Arguments),
    /// Write a film or an image in another format.
    Convert(convert::Arguments),
    /// Render the two half-references of a scene.
    Reference(reference::Arguments),
}

impl Image {
    pub(super) fn run(self, lab: &Arc<Lab>, console: &Console) -> Result<()> {
        match self {
            Self::Compare(arguments) => compare::run(&arguments),
            Self::Convert(arguments) => convert::run(&arguments),
            Self::Reference(arguments) => reference::run(&arguments, lab, console),
        }
    }
}
