//! `--kernel lanes+device:ID`, or with several devices `lanes+device:ID+device:ID`: workers render pieces with a kernel
//! of the processor, while devices render others. All these kernels produce the same bits, so the assignment of pieces
//! changes none.

use super::device::OnDevice;
use super::{Counts, Kernel};
use crate::error::Error;
use crate::film::{Piece, TileBuffer};
use pathmark_device::Costs;

/// A kernel of the processor and kernels of devices.
pub(super) struct Beside {
    pub(super) own: Box<dyn Kernel>,
    pub(super) devices: Vec<OnDevice>,
}

impl Kernel for Beside {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        self.own.render(piece, out)
    }

    fn failure(&self) -> Option<Error> {
        self.devices.iter().find_map(Kernel::failure)
    }

    fn remarks(&self) -> Vec<String> {
        self.devices.iter().flat_map(Kernel::remarks).collect()
    }

    fn costs(&self) -> Option<Costs> {
        self.devices
            .iter()
            .filter_map(Kernel::costs)
            .reduce(|a, b| Costs { compile_s: a.compile_s + b.compile_s, copy_s: a.copy_s + b.copy_s })
    }

    fn beside(&self) -> Vec<&dyn Kernel> {
        self.devices.iter().map(|device| device as &dyn Kernel).collect()
    }
}
