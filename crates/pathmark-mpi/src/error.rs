use std::path::PathBuf;
use thiserror::Error;

/// The reason why there is no MPI, or why a call failed.
#[derive(Debug, Error)]
pub enum MpiError {
    /// No library was found under any of the usual names.
    #[error("no MPI library was found: {tried}. Install one (Debian: mpich), or name its file")]
    Missing {
        /// The system's error for each name.
        tried: String,
    },
    /// The file that the user named cannot be opened as a library.
    #[error("{} cannot be opened as a library: {why}", path.display())]
    NoLibrary {
        path: PathBuf,
        /// The system's error.
        why: String,
    },
    /// The library lacks a function.
    #[error("{library} is not an MPI library, or is too old: it has no {symbol}")]
    NoSymbol { library: String, symbol: &'static str },
    /// The library of another launcher: each process would be the only one in its own world.
    #[error(
        "the launcher started {launched} processes, but {library} knows of {known}: start them with the mpiexec of that library, or name the launcher's library"
    )]
    WrongLauncher {
        /// Number of processes according to the launcher.
        launched: usize,
        /// Number of processes according to the library.
        known: usize,
        library: String,
    },
    #[error("{call} failed with MPI's error {code}")]
    Call {
        call: &'static str,
        /// The returned error code.
        code: i32,
    },
    /// A message is longer than MPI can count.
    #[error("a message of {words} words is too long for MPI")]
    TooLong {
        /// Its length in 64-bit words.
        words: usize,
    },
}
