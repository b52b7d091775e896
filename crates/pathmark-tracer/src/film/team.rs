//! Work on the parts of a film that several threads share out among themselves.

use std::sync::{Mutex, PoisonError};
use std::thread::{Builder, scope};

/// Does `work` for each item, with up to `threads` threads: whichever is free takes the next one.
pub(super) fn for_each<T: Send>(items: impl Iterator<Item = T> + Send, threads: usize, work: impl Fn(T) + Sync) {
    if threads < 2 {
        return items.for_each(work);
    }
    let waiting = Mutex::new(items);
    let work = || {
        loop {
            let next = waiting.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some(item) = next else { return };
            work(item);
        }
    };
    scope(|scope| {
        // If the system refuses a thread, the calling thread does the rest.
        for _ in 1..threads {
            if Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
}
