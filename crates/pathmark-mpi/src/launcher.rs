//! What a launcher tells the processes that it starts, before MPI is asked.

use std::env;

/// The place of this process among those that a launcher started.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Launcher {
    /// How many processes there are.
    pub size: usize,
    /// The number of this one, from 0.
    pub rank: usize,
    /// Whether it is Open MPI's.
    pub is_open_mpi: bool,
}

/// The variables of each launcher: whether it is Open MPI's, the number of processes, and the number of this one.
const VARIABLES: [(bool, &str, &str); 2] =
    [(true, "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"), (false, "PMI_SIZE", "PMI_RANK")];

impl Launcher {
    /// The launcher of this process; `None` if nobody says so.
    pub fn of_environment() -> Option<Self> {
        let read = |name: &str| env::var(name).ok()?.parse().ok();
        VARIABLES
            .iter()
            .find_map(|&(is_open_mpi, size, rank)| Some(Self { size: read(size)?, rank: read(rank)?, is_open_mpi }))
    }
}
