//! One ray against many boxes or primitives at a time: for scenes with triangles, and for large scenes. The rays of a
//! packet go in all directions. So a ray that traverses a hierarchy alone tests fewer boxes than the whole packet
//! together (Wald, Benthin and Boulos, "Getting Rid of Packets", 2008).
//!
//! The result does not depend on how many are tested at a time. Preceding tests in single precision have a padding that
//! covers all rounding errors, and among equally near primitives the lowest number wins. In double precision the result
//! equals the scalar search's, to the bit. In single precision one formula tests each primitive, with and without a
//! tree; spheres have the formulas of [`SpheresF32`].

mod best;
mod blocks;
mod coarse;
mod collapse;
mod linear;
mod ray_packet;
mod robust;
mod tree;
mod uncertain;
mod wide;

pub(in crate::lanes) use tree::{Stack, Stacks};
pub(in crate::lanes) use wide::{Nearest, Scratch, Wide};
