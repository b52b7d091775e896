//! Steps of writing to a disk, each of which a test can make fail.
//!
//! A full disk, an exhausted quota or a broken cable can cause an error at any step: when a file is created, during a
//! write, when the system syncs the bytes, or at the rename. All output of the program passes through this module, so
//! tests can try every fault with every output, in any build. Faults affect only the thread that set them.

use std::cell::RefCell;
use std::io::{self, Write};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    Create,
    /// This many bytes are handed to the system.
    Write(usize),
    /// The system is asked to sync the written bytes to the disk.
    Sync,
    Rename,
}

/// The behaviour of a disk at a step: an error of the system, or how many bytes of a write it accepts.
pub type Faults = dyn FnMut(Step) -> io::Result<usize>;

thread_local! {
    static FAULTS: RefCell<Option<Box<Faults>>> = const { RefCell::new(None) };
}

/// Runs `body` in this thread; each step of its output has the result that `faults` returns.
///
/// ```
/// use pathmark_harness::{atomic_file, disk};
/// use std::io::ErrorKind::StorageFull;
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("out.txt");
/// let full = disk::with_faults(|_| Err(StorageFull.into()), || atomic_file::write(&path, |out| out.write_all(b"text")));
/// assert_eq!(full.unwrap_err().exit_code(), 3);
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn with_faults<R>(faults: impl FnMut(Step) -> io::Result<usize> + 'static, body: impl FnOnce() -> R) -> R {
    /// Removes the faults, also when `body` panics.
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

/// Checks whether the disk allows a step other than a write.
pub fn step(step: Step) -> io::Result<()> {
    allowed(step).map(|_| ())
}

fn allowed(step: Step) -> io::Result<usize> {
    FAULTS.with_borrow_mut(|faults| faults.as_mut().map_or(Ok(usize::MAX), |faults| faults(step)))
}

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
