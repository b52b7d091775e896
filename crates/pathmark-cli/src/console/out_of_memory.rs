//! Out of memory: an exit code and a message where Rust has no error for refused memory.
//!
//! Memory that is large or depends on user input is requested early, and a refusal is an ordinary error. If a small
//! allocation fails, or a new thread gets no stack for its signals, Rust's runtime aborts. This module turns such an
//! abort into an error of the system: a message, and exit code 3. Files that were being written leave their temporary
//! files behind, as after a kill. Two failures are not covered: before `main`, where the system may be unable to load
//! the program, and on the main thread's own stack.
//!
//! An abort does not say why it happens. The error number tells it, unless the runtime prints a backtrace in between,
//! which overwrites the number. The program's allocator therefore remembers that memory was refused.

#![expect(unsafe_code, reason = "handlers of signals belong to the C library, and an allocator deals in pointers")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io;
use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};

const SAID: &[u8] = b"pathmark: the system refused memory\n";
/// The exit code of [`crate::error::Error::System`].
const EXIT_CODE: libc::c_int = 3;

/// The source file in which the runtime panics if a thread gets no stack for its signals. The usual message of that
/// panic takes memory, and may wait for ever.
const SIGNAL_STACKS: &str = "stack_overflow.rs";

/// Whether the system has refused memory to [`Allocator`].
static REFUSED: AtomicBool = AtomicBool::new(false);

/// The system's allocator, which remembers refusals. The program `pathmark` uses it; another program with this command
/// line may do so, too. Without it, refused memory that aborts the program has no exit code of its own if
/// `RUST_BACKTRACE` is set.
///
/// ```
/// # use pathmark_cli as pathmark;
/// #[global_allocator]
/// static ALLOCATOR: pathmark::Allocator = pathmark::Allocator;
/// ```
pub struct Allocator;

fn noted(memory: *mut u8) -> *mut u8 {
    if memory.is_null() {
        REFUSED.store(true, Ordering::Relaxed);
    }
    memory
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Allocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the same promises.
        noted(unsafe { System.alloc(layout) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller keeps the same promises.
        noted(unsafe { System.alloc_zeroed(layout) })
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller keeps the same promises.
        noted(unsafe { System.realloc(memory, layout, size) })
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the same promises.
        unsafe { System.dealloc(memory, layout) };
    }
}

/// From now on, an abort for lack of memory prints a message and has an exit code. Other aborts and panics stay
/// unchanged.
pub(crate) fn watch() {
    let handler: extern "C" fn(libc::c_int) = aborting;
    // SAFETY: the handler does nothing but what a handler of signals may do.
    unsafe { libc::signal(libc::SIGABRT, handler as libc::sighandler_t) };
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |panic| {
        if panic.location().is_some_and(|place| place.file().ends_with(SIGNAL_STACKS)) {
            end();
        }
        usual(panic);
    }));
}

/// The handler of SIGABRT. If it returns, `abort` ends the process by its signal.
extern "C" fn aborting(_: libc::c_int) {
    // Both the C library's allocator and its `mmap` set this error number.
    let is_refused = io::Error::last_os_error().raw_os_error() == Some(libc::ENOMEM);
    if is_refused || REFUSED.load(Ordering::Relaxed) {
        end();
    }
}

fn end() -> ! {
    // SAFETY: both may be called at any time, also in a handler; the text is as long as it says.
    unsafe {
        libc::write(libc::STDERR_FILENO, SAID.as_ptr().cast(), SAID.len());
        libc::_exit(EXIT_CODE)
    }
}
