//! A parallel loop of libgomp, through the few lines of C in `shim.c`. This is the strategies' only unsafe code.
#![expect(unsafe_code, reason = "pragmas need C, and C is called by pointers; each block says why it is sound")]

use std::ffi::{c_int, c_void};
use std::ptr;

/// OpenMP's schedules, with the numbers of its `omp_sched_t`.
#[derive(Debug, Clone, Copy)]
pub(in crate::strategies) enum Schedule {
    Static = 1,
    Dynamic = 2,
    Guided = 3,
}

unsafe extern "C" {
    fn pathmark_openmp_run(
        schedule: c_int,
        chunk: c_int,
        threads: c_int,
        jobs: usize,
        job: unsafe extern "C" fn(*const c_void, usize),
        context: *const c_void,
    ) -> c_int;
}

/// Calls `body(i)` once for each `i` below `jobs`, on a team of `threads` (at least 1) that the calling thread leads.
/// Returns when all calls have returned. `chunk` is 0 for the schedule's own size. `body` must not panic: a panic would
/// end the program.
///
/// Returns the size of the team. If it is less than `threads`, `body` has not been called.
pub(super) fn parallel_for<F: Fn(usize) + Sync>(
    schedule: Schedule,
    chunk: c_int,
    threads: c_int,
    jobs: usize,
    body: &F,
) -> c_int {
    // SAFETY: the signature is that of shim.c, whose `size_t` is `usize` on every platform with libgomp. `call::<F>` gets the pointer back
    // that is given here, on threads of the team, which have all left the loop when this returns: `body` lives longer.
    unsafe { pathmark_openmp_run(schedule as c_int, chunk, threads, jobs, call::<F>, ptr::from_ref(body).cast()) }
}

/// `context` must point to an `F` that lives throughout the call.
unsafe extern "C" fn call<F: Fn(usize) + Sync>(context: *const c_void, index: usize) {
    // SAFETY: by the contract above. Several threads may be here at once, which `Sync` allows. A panic can't unwind into C: it ends the
    // program at this function's border.
    let body = unsafe { &*context.cast::<F>() };
    body(index);
}
