//! Out of memory: an exit code and a message where Rust has no error for refused memory.
//!
//! Memory that is large or depends on user input is requested early, and a refusal is an ordinary error. If a small
//! allocation fails, or a new thread gets no stack for its signals, Rust's runtime aborts. This module turns such an
//! abort into an error of the system: a message, and exit code 3. Files that were being written leave their temporary
//! files behind, as after a kill. Two failures are not covered: before `main`, where the system may be unable to load
//! the program, and on the main thread's own stack.

#![expect(unsafe_code, reason = "handlers of signals belong to the C library")]

use std::io;
use std::panic;

const SAID: &[u8] = b"pathmark: the system refused memory\n";
/// The exit code of [`crate::error::Error::System`].
const EXIT_CODE: libc::c_int = 3;

/// The source file in which the runtime panics if a thread gets no stack for its signals. The usual message of that
/// panic takes memory, and may wait for ever.
const SIGNAL_STACKS: &str = "stack_overflow.rs";

/// From now on, an abort for lack of memory prints a message and has an exit code. Other aborts and panics stay
/// unchanged.
pub(super) fn watch() {
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
    // Both the C library's allocator and its `mmap` set this error number, and the runtime's message in between does
    // not fail.
    if io::Error::last_os_error().raw_os_error() == Some(libc::ENOMEM) {
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
