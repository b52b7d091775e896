//! Launcher: the environment variables that a launcher sets for its processes, read before MPI begins.

use std::env;

/// The position of this process among those that a launcher started.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Launcher {
    pub size: usize,
    /// Index of this process, from 0.
    pub rank: usize,
    /// Whether the launcher is Open MPI's.
    pub is_open_mpi: bool,
}

/// The variables of each launcher: whether it is Open MPI's, the number of processes, and the index of this one.
const VARIABLES: [(bool, &str, &str); 2] =
    [(true, "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), (false, "PMI_SIZE", "PMI_RANK")];

impl Launcher {
    /// The launcher of this process; `None` if no variables name one.
    pub fn of_environment() -> Option<Self> {
        let read = |name: &str| env::var(name).ok()?.parse().ok();
        VARIABLES
            .iter()
            .find_map(|&(is_open_mpi, size, rank)| Some(Self { size: read(size)?, rank: read(rank)?, is_open_mpi }))
    }
}
