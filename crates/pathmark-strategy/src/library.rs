//! Support for libraries that start their own threads, and panic or end the program if the system refuses one.

use std::any::Any;
use std::io;
use std::panic::{self, AssertUnwindSafe};

use crossbeam::channel;

use crate::team::Crew;
use crate::{Blueprint, StrategyError};

/// Starts `threads` threads from the spawner, all alive at the same time, and ends them again. A refused thread is an
/// error here, where the library would panic or end the program.
///
/// This does not guarantee that the library then gets its threads: another program may take them in between.
pub fn rehearse(blueprint: &Blueprint, threads: usize) -> Result<(), StrategyError> {
    let mut crew = Crew::default();
    // Dropped before the crew: dropping `_end` ends the threads that the crew then joins.
    let (_end, ended) = channel::bounded::<()>(0);
    (0..threads).try_for_each(|_| {
        let ended = ended.clone();
        crew.hire(&*blueprint.spawner, threads, move || {
            let _ = ended.recv();
        })
    })
}

/// Starts a library's pool of `threads` threads after a rehearsal. A panic of the library is an error, too; the
/// threads that it had started until then stay.
pub fn start<T>(blueprint: &Blueprint, threads: usize, start: impl FnOnce() -> T) -> Result<T, StrategyError> {
    rehearse(blueprint, threads)?;
    panic::catch_unwind(AssertUnwindSafe(start)).map_err(|payload| StrategyError::Spawn {
        worker: threads,
        workers: threads,
        source: io::Error::other(message(&*payload)),
    })
}

/// Returns the message of a panic.
pub(crate) fn message(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("a payload without a message").to_owned()
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroUsize;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread::JoinHandle;

    use super::*;
    use crate::{Discipline, Spawner, SystemThreads};

    /// A spawner that allows this many threads at a time.
    struct Few(usize, Arc<AtomicUsize>);

    impl Spawner for Few {
        fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
            if self.1.fetch_add(1, Ordering::SeqCst) >= self.0 {
                return Err(io::ErrorKind::WouldBlock.into());
            }
            let alive = Arc::clone(&self.1);
            let body = move || {
                body();
                alive.fetch_sub(1, Ordering::SeqCst);
            };
            SystemThreads.spawn(name, Box::new(body))
        }
    }

    fn blueprint(threads: usize) -> Blueprint {
        let spawner = Arc::new(Few(threads, Arc::default()));
        Blueprint { strategy: "library", discipline: Discipline::Halving, threads: NonZeroUsize::MIN, spawner }
    }

    #[test]
    fn a_rehearsal_needs_all_threads_at_the_same_time() {
        assert!(rehearse(&blueprint(4), 4).is_ok());
        let refused = rehearse(&blueprint(3), 4);
        assert!(matches!(refused, Err(StrategyError::Spawn { worker: 4, workers: 4, .. })), "{refused:?}");
    }

    #[test]
    fn a_library_that_panics_is_an_error_with_its_message() {
        let refused = start(&blueprint(2), 2, || panic!("failed to spawn thread")).err().map(|error| error.to_string());
        assert_eq!(refused.as_deref(), Some("starting worker 2 of 2: failed to spawn thread"));
        assert_eq!(start(&blueprint(2), 2, || 7).ok(), Some(7));
    }
}
