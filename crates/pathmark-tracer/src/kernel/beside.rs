//! `--kernel lanes+device:ID`: workers render pieces with a kernel of the processor, and a device renders others meanwhile. Which piece was rendered by
//! whom changes no bit, because both kernels have the same.

use super::device::OnDevice;
use super::{Counts, Kernel};
use crate::error::Error;
use crate::film::{Piece, TileBuffer};

/// Both kernels.
pub(super) struct Beside {
    pub(super) own: Box<dyn Kernel>,
    pub(super) device: OnDevice,
}

impl Kernel for Beside {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        self.own.render(piece, out)
    }

    fn failure(&self) -> Option<Error> {
        self.device.failure()
    }

    fn beside(&self) -> Option<&dyn Kernel> {
        Some(&self.device)
    }
}
