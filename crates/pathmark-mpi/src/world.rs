//! World: all processes of a run.
#![expect(
    unsafe_code,
    reason = "calls of C functions with buffers whose lengths are told; each block says why it is sound"
)]

use crate::MpiError;
use crate::launcher::Launcher;
use crate::library::Library;
use std::ffi::{c_char, c_int, c_void};
use std::path::Path;
use std::ptr::null_mut;

/// Longer than any library's version text (`MPI_MAX_LIBRARY_VERSION_STRING` is 8192 in MPICH, 256 in Open MPI).
const LONGEST_VERSION: usize = 1 << 16;
/// Larger than any library's `MPI_Status`.
const STATUS_WORDS: usize = 16;
/// The tag of messages between two ranks.
const TAG: c_int = 0x70;

/// The processes that a launcher started together; only this one without a launcher. MPI can begin only once in a
/// process.
pub struct World {
    pub(crate) library: Library,
    rank: usize,
    size: usize,
    version: String,
}

pub(crate) fn checked(call: &'static str, code: c_int) -> Result<(), MpiError> {
    if code == 0 { Ok(()) } else { Err(MpiError::Call { call, code }) }
}

fn count(words: usize) -> Result<c_int, MpiError> {
    c_int::try_from(words).map_err(|_| MpiError::TooLong { words })
}

impl World {
    /// Opens the library that the user names, or one of the usual ones, and starts MPI.
    pub fn begin(named: Option<&Path>) -> Result<Self, MpiError> {
        let library = Library::open(named)?;
        let (mut rank, mut size, mut provided) = (0, 0, 0);
        let (functions, abi) = (&library.functions, &library.abi);
        // SAFETY: MPI allows no arguments; `provided` outlives the call.
        checked("MPI_Init_thread", unsafe {
            (functions.init_thread)(null_mut(), null_mut(), abi.funneled, &raw mut provided)
        })?;
        // SAFETY: MPI has begun, and the numbers outlive the calls.
        checked("MPI_Comm_rank", unsafe { (functions.rank)(abi.world, &raw mut rank) })?;
        // SAFETY: as above.
        checked("MPI_Comm_size", unsafe { (functions.size)(abi.world, &raw mut size) })?;
        let mut text = vec![0_u8; LONGEST_VERSION];
        let mut length = 0;
        // SAFETY: no library writes more than the text has room for.
        checked("MPI_Get_library_version", unsafe {
            (functions.version)(text.as_mut_ptr().cast::<c_char>(), &raw mut length)
        })?;
        text.truncate(usize::try_from(length).unwrap_or(0).min(LONGEST_VERSION));
        let version = short_version(&String::from_utf8_lossy(&text), abi.name);
        let number = |value: c_int| usize::try_from(value).unwrap_or(0);
        let world = Self { library, rank: number(rank), size: number(size), version };
        match Launcher::of_environment() {
            Some(launcher) if launcher.size != world.size => Err(MpiError::WrongLauncher {
                launched: launcher.size,
                known: world.size,
                library: world.library.name.clone(),
            }),
            _ => Ok(world),
        }
    }

    /// The index of this process, from 0.
    pub fn rank(&self) -> usize {
        self.rank
    }

    pub fn size(&self) -> usize {
        self.size
    }

    /// The library's name and version, as in `MPICH 4.0.2`.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Waits until all ranks have called it.
    pub fn barrier(&self) -> Result<(), MpiError> {
        // SAFETY: MPI has begun.
        checked("MPI_Barrier", unsafe { (self.library.functions.barrier)(self.library.abi.world) })
    }

    /// Sends words to rank `to`.
    pub fn send(&self, to: usize, words: &[u64]) -> Result<(), MpiError> {
        let (length, to) = (count(words.len())?, count(to)?);
        let (functions, abi) = (&self.library.functions, &self.library.abi);
        // SAFETY: the buffer has `length` words.
        checked("MPI_Send", unsafe { (functions.send)(words.as_ptr().cast(), length, abi.int64, to, TAG, abi.world) })
    }

    /// Waits for words from rank `from`, or from any rank.
    pub fn receive(&self, from: Option<usize>, words: &mut [u64]) -> Result<(), MpiError> {
        let (functions, abi) = (&self.library.functions, &self.library.abi);
        let (length, from) = (count(words.len())?, from.map_or(Ok(abi.any_source), count)?);
        let mut status = [0_u64; STATUS_WORDS];
        // SAFETY: the buffer has `length` words, and the status is larger than any library's.
        checked("MPI_Recv", unsafe {
            let status = status.as_mut_ptr().cast::<c_void>();
            (functions.receive)(words.as_mut_ptr().cast(), length, abi.int64, from, TAG, abi.world, status)
        })
    }

    /// Whether words from any rank wait to be received. MPICH's probe returns before it processes messages that have
    /// arrived meanwhile, so this probes twice.
    pub fn has_message(&self) -> Result<bool, MpiError> {
        Ok(self.probe()? || self.probe()?)
    }

    fn probe(&self) -> Result<bool, MpiError> {
        let (functions, abi) = (&self.library.functions, &self.library.abi);
        let (mut flag, mut status) = (0, [0_u64; STATUS_WORDS]);
        // SAFETY: flag and status outlive the call, and the status is larger than any library's.
        checked("MPI_Iprobe", unsafe {
            (functions.probe)(abi.any_source, TAG, abi.world, &raw mut flag, status.as_mut_ptr().cast::<c_void>())
        })?;
        Ok(flag != 0)
    }

    /// Returns the words of all ranks, in the order of ranks. All ranks must pass equally many.
    pub fn all_gather(&self, words: &[u64]) -> Result<Vec<u64>, MpiError> {
        let mut all = vec![0; words.len() * self.size];
        let length = count(words.len())?;
        let (functions, abi) = (&self.library.functions, &self.library.abi);
        // SAFETY: there is room for `length` words of each rank.
        checked("MPI_Allgather", unsafe {
            let (mine, all) = (words.as_ptr().cast(), all.as_mut_ptr().cast());
            (functions.all_gather)(mine, length, abi.int64, all, length, abi.int64, abi.world)
        })?;
        Ok(all)
    }

    /// Returns the words of all ranks in the order of ranks, on rank 0; an empty vector on the others.
    pub fn gather(&self, words: &[u64]) -> Result<Vec<u64>, MpiError> {
        let lengths = self.all_gather(&[words.len() as u64])?;
        let total: u64 = lengths.iter().sum();
        let counts = lengths.iter().map(|length| count(*length as usize)).collect::<Result<Vec<_>, _>>()?;
        count(total as usize)?;
        let starts: Vec<c_int> = counts
            .iter()
            .scan(0, |at, length| {
                let start = *at;
                *at += length;
                Some(start)
            })
            .collect();
        let mut all = if self.rank == 0 { vec![0; total as usize] } else { Vec::new() };
        let (functions, abi) = (&self.library.functions, &self.library.abi);
        // SAFETY: each rank has the number of words that it has sent to all others, and rank 0 has room for all of
        // them.
        checked("MPI_Gatherv", unsafe {
            let (mine, all) = (words.as_ptr().cast(), all.as_mut_ptr().cast());
            let (length, counts, starts) = (counts[self.rank], counts.as_ptr(), starts.as_ptr());
            (functions.gather_v)(mine, length, abi.int64, all, counts, starts, abi.int64, 0, abi.world)
        })?;
        Ok(all)
    }

    /// Ends MPI; all ranks must call this.
    pub fn end(self) -> Result<(), MpiError> {
        // SAFETY: MPI has begun, and `self` is gone after this.
        checked("MPI_Finalize", unsafe { (self.library.functions.finalize)() })
    }
}

/// Shortens `MPICH Version: 4.0.2 ...` and `Open MPI v5.0.11, package: ...` to name and version.
fn short_version(text: &str, abi: &str) -> String {
    let number = text.split(|c: char| c.is_whitespace() || c == ',').map(|word| word.trim_start_matches('v'));
    let number = number.into_iter().find(|word| word.contains('.') && word.starts_with(|c: char| c.is_ascii_digit()));
    let name = if text.starts_with("Open MPI") {
        "Open MPI"
    } else if text.starts_with("MPICH") {
        "MPICH"
    } else {
        abi
    };
    format!("{name} {}", number.unwrap_or("of unknown version"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_short() {
        for (text, expected) in [
            ("MPICH Version:\t4.0.2\nMPICH Release date:\tThu Apr  7", "MPICH 4.0.2"),
            ("Open MPI v5.0.11, package: Open MPI root@x Distribution", "Open MPI 5.0.11"),
            ("Cray", "MPICH of unknown version"),
        ] {
            assert_eq!(short_version(text, "MPICH"), expected);
        }
    }

    #[test]
    fn files_that_are_no_libraries_are_errors() {
        let refused = |path: &str| World::begin(Some(Path::new(path))).err().unwrap().to_string();
        assert!(refused("/etc/passwd").contains("/etc/passwd"));
        assert!(refused("/nowhere/libmpi.so").contains("/nowhere/libmpi.so"));
        // Apple's systems have the C library under another name.
        let c_library = if cfg!(target_vendor = "apple") { "libSystem.B.dylib" } else { "libc.so.6" };
        assert!(refused(c_library).contains("MPI_Init_thread"));
    }
}
