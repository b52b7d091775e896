//! Binary interfaces of MPI libraries: the same functions with different constants.
//!
//! Handles are numbers in MPICH (and in Intel's and Cray's libraries, which share its interface) and in the interface
//! that MPI 5.0 standardises. In Open MPI they are addresses. All fit into a pointer and are stored as such. Sources:
//! `mpi.h` of MPICH 4.0 and of Open MPI 4.1, and MPI 5.0, chapter 20 (2025).

use crate::library::Symbols;

/// A handle of MPI, or an address.
pub(crate) type Handle = usize;

/// The constants that the libraries' headers define.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Abi {
    pub(crate) name: &'static str,
    pub(crate) world: Handle,
    pub(crate) int64: Handle,
    pub(crate) sum: Handle,
    pub(crate) no_info: Handle,
    pub(crate) any_source: i32,
    /// Thread level: one thread makes all calls, and other threads exist.
    pub(crate) funneled: i32,
}

const MPICH: Abi = Abi {
    name: "MPICH",
    world: 0x4400_0000,
    int64: 0x4c00_083a,
    sum: 0x5800_0003,
    no_info: 0x1c00_0000,
    any_source: -2,
    funneled: 1,
};

const STANDARD: Abi =
    Abi { name: "MPI 5", world: 0x101, int64: 0x258, sum: 0x21, no_info: 0x130, any_source: -1, funneled: 1024 };

impl Abi {
    /// Detects the interface of an open library. MPICH's own interface and MPI 5's have the same functions; the file
    /// name tells them apart.
    pub(crate) fn of(symbols: &Symbols) -> Self {
        let address = |name| symbols.address(name);
        let open_mpi = (|| {
            Some(Self {
                name: "Open MPI",
                world: address(c"ompi_mpi_comm_world")?,
                int64: address(c"ompi_mpi_int64_t")?,
                sum: address(c"ompi_mpi_op_sum")?,
                no_info: address(c"ompi_mpi_info_null")?,
                any_source: -1,
                funneled: 1,
            })
        })();
        open_mpi.unwrap_or(if symbols.file_name().starts_with("libmpi_abi") { STANDARD } else { MPICH })
    }
}
