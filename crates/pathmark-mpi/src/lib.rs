//! MPI without linking: the library is opened at run time, so one binary runs on MPICH and Open MPI, and without
//! either.
//!
//! It covers the calls that self-scheduling between processes needs: ranks, a barrier, messages, a gather, and a
//! counter that all ranks share. Messages are of 64-bit words. One thread of each rank makes all calls.

mod abi;
mod counter;
mod error;
mod launcher;
mod library;
mod world;

pub use counter::Counter;
pub use error::MpiError;
pub use launcher::Launcher;
pub use world::World;
