//! The steps by which bytes reach a disk, each of which a test can make fail.
//!
//! A full disk, a used-up quota, a broken cable show themselves at any of them: when a file is made, in the middle of a write, when the
//! system is asked whether the bytes are safe, or at the rename. Everything that the program writes goes through here, so that all of these
//! can be tried with all outputs, in any build. Faults belong to the thread that asked for them.

use std::cell::RefCell;
use std::io::{self, Write};

/// What is about to be done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// A file is made.
    Create,
    /// So many bytes are handed to the system.
    Write(usize),
    /// The system is asked to make sure of what was written.
    Sync,
    /// A finished file takes its name.
    Rename,
}

/// What a disk does at a step: the error that the system would give, or how many bytes of a write it takes.
pub type Faults = dyn FnMut(Step) -> io::Result<usize>;

thread_local! {
    static FAULTS: RefCell<Option<Box<Faults>>> = const { RefCell::new(None) };
}

/// Runs `body` with a disk that behaves as `faults` say, in this thread.
///
/// ```
/// use pathmark::{atomic_file, disk};
/// use std::io::ErrorKind::StorageFull;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("out.txt");
/// let full = disk::with_faults(|_| Err(StorageFull.into()), || atomic_file::write(&path, |out| out.write_all(b"text")));
/// assert_eq!(full.unwrap_err().exit_code(), 3);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn with_faults<R>(faults: impl FnMut(Step) -> io::Result<usize> + 'static, body: impl FnOnce() -> R) -> R {
    /// Puts the sound disk back, also when `body` panics.
    struct Repair;
    impl Drop for Repair {
        fn drop(&mut self) {
            FAULTS.set(None);
        }
    }
    let _repair = Repair;
    FAULTS.set(Some(Box::new(faults)));
    body()
}

/// Asks the disk for a step other than a write.
pub fn step(step: Step) -> io::Result<()> {
    allowed(step).map(|_| ())
}

/// How many bytes of a write are taken.
fn allowed(step: Step) -> io::Result<usize> {
    FAULTS.with_borrow_mut(|faults| faults.as_mut().map_or(Ok(usize::MAX), |faults| faults(step)))
}

/// A file on the disk.
#[derive(Debug)]
pub struct OnDisk<F>(pub F);

impl<F: Write> Write for OnDisk<F> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = allowed(Step::Write(bytes.len()))?.min(bytes.len());
        self.0.write(&bytes[..taken])
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}
