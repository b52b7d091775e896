//! A shared counter: a number in the memory of rank 0 that all ranks increment.
#![expect(unsafe_code, reason = "calls of C functions; each block says why it is sound")]

use crate::MpiError;
use crate::abi::Handle;
use crate::world::{World, checked};
use std::ptr::null_mut;

/// A counter that starts at 0. It is one-sided: rank 0 need not answer, as far as its library makes progress by itself.
pub struct Counter<'a> {
    world: &'a World,
    window: Handle,
    /// The addend, and the counter's previous value.
    words: *mut [u64; 2],
    is_asked: bool,
}

impl<'a> Counter<'a> {
    /// Creates a counter; all ranks must call this together.
    pub fn new(world: &'a World) -> Result<Self, MpiError> {
        let (functions, abi) = (&world.library.functions, &world.library.abi);
        let bytes = if world.rank() == 0 { size_of::<u64>() as isize } else { 0 };
        let (mut base, mut window) = (null_mut(), 0);
        // SAFETY: base and window outlive the call.
        checked("MPI_Win_allocate", unsafe {
            (functions.window_allocate)(bytes, 8, abi.no_info, abi.world, &raw mut base, &raw mut window)
        })?;
        if world.rank() == 0 {
            // SAFETY: MPI has allocated this word, and no other rank reads it before the barrier.
            unsafe { base.cast::<u64>().write(0) };
        }
        world.barrier()?;
        // SAFETY: the window exists.
        checked("MPI_Win_lock_all", unsafe { (functions.window_lock_all)(0, window) })?;
        // These sixteen bytes are never freed: after an error the library may still write to them.
        let words = Box::into_raw(Box::new([1, 0]));
        Ok(Self { world, window, words, is_asked: false })
    }

    /// Requests the next number without waiting for it.
    pub fn ask(&mut self) -> Result<(), MpiError> {
        if self.is_asked {
            return Ok(());
        }
        let (functions, abi) = (&self.world.library.functions, &self.world.library.abi);
        // SAFETY: both words stay allocated and untouched until the flush that completes the operation.
        checked("MPI_Fetch_and_op", unsafe {
            let (one, found) = ((&raw const (*self.words)[0]).cast(), (&raw mut (*self.words)[1]).cast());
            (functions.fetch_and_op)(one, found, abi.int64, 0, 0, abi.sum, self.window)
        })?;
        self.is_asked = true;
        Ok(())
    }

    /// Returns the requested number, or requests the next one, and waits for it. Every request increments the counter.
    pub fn number(&mut self) -> Result<u64, MpiError> {
        self.ask()?;
        let functions = &self.world.library.functions;
        // SAFETY: the window exists and is locked.
        checked("MPI_Win_flush", unsafe { (functions.window_flush)(0, self.window) })?;
        self.is_asked = false;
        // SAFETY: the operation is complete, so MPI no longer uses the words.
        Ok(unsafe { (*self.words)[1] })
    }

    /// Frees the counter; all ranks must call this together.
    pub fn free(mut self) -> Result<(), MpiError> {
        let functions = &self.world.library.functions;
        // SAFETY: the window exists and is locked.
        checked("MPI_Win_unlock_all", unsafe { (functions.window_unlock_all)(self.window) })?;
        // SAFETY: the window exists, and nothing uses it afterwards.
        checked("MPI_Win_free", unsafe { (functions.window_free)(&raw mut self.window) })
    }
}
