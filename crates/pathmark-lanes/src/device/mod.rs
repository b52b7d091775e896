//! `--kernel device`: pieces are rendered by a GPU, through CUDA or OpenCL, or by another device that compiles the
//! program in `program/`.
//!
//! The program is the scalar kernel's path in the common subset of C, OpenCL C and CUDA C, operation by operation. So
//! an image has the same bits on every device and on the processor; in single precision the path is the path of lanes.
//! The program is compiled when a kernel is built, for an effect profile like a scalar kernel. The scalar kernel's
//! tables of constants are written into its text ([`program`]); the scene goes to the device as arrays ([`tables`]). A
//! launch has as many items ([`items`]) as take a quarter of a second, because display drivers abort longer ones.

mod hybrid;
mod items;
mod on_device;
mod plan;
mod program;
mod tables;

pub(crate) use hybrid::HYBRID;
pub(crate) use plan::DEVICE;
