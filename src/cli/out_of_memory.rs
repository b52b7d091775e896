//! Memory that the system refuses where Rust has no error for it.
//!
//! What is large or comes from a user's input is asked for in good time, and its refusal is an error like any other. When one of the many small
//! allocations fails, or a thread that starts gets no stack for its signals, Rust's runtime aborts. Here such an end becomes what any refusal of
//! the system is: a line that says so, and exit code 3. Files that were being written leave their temporary ones behind, as after a kill.
//! No promise holds before `main`, where the system may be unable to load the program, nor for the main thread's own stack.

#![expect(unsafe_code, reason = "handlers of signals belong to the C library")]

use std::io;
use std::panic;

const SAID: &[u8] = b"pathmark: the system refused memory\n";
/// What [`crate::error::Error::System`] ends with.
const EXIT_CODE: libc::c_int = 3;

/// Where the runtime panics if a thread gets no stack for its signals. Telling that panic in the usual way takes memory, and may wait for ever.
const SIGNAL_STACKS: &str = "stack_overflow.rs";

/// From now on, an end of this process for want of memory is told and has an exit code. Other aborts and panics stay what they are.
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

/// If it returns, `abort` goes on and ends the process by its signal.
extern "C" fn aborting(_: libc::c_int) {
    // Both the C library's allocator and its `mmap` leave this number behind, and what the runtime prints in between does not fail.
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
