//! Errors for a refused thread: they name its number and the total. The contract already requires that it is an error.

use std::io;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;

use pathmark_strategy::{Config, STRATEGIES, Spawner, StrategyError, SystemThreads, Threads, find};

/// A spawner that refuses the thread of this number, counted from 0.
struct Refusing(usize, AtomicUsize);

impl Spawner for Refusing {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        if self.1.fetch_add(1, Ordering::SeqCst) == self.0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        SystemThreads.spawn(name, body)
    }
}

fn config(threads: usize, refused: usize) -> Config {
    let spawner = Arc::new(Refusing(refused, AtomicUsize::new(0)));
    Config { spawner, ..Config::new(NonZeroUsize::new(threads).expect("at least one thread")) }
}

#[test]
fn a_refused_thread_is_named() {
    const THREADS: usize = 8;
    for entry in STRATEGIES {
        for refused in 0..entry.workers.at_once(THREADS, THREADS) {
            let made = entry.build(config(THREADS, refused));
            let outcome = made.and_then(|mut strategy| strategy.run(THREADS, Arc::new(|_| ())));
            let Err(StrategyError::Spawn { worker, workers, source }) = &outcome else {
                assert_eq!(entry.name, "serial", "{outcome:?}");
                continue;
            };
            assert_eq!((*worker, source.kind()), (refused + 1, io::ErrorKind::WouldBlock), "{}", entry.name);
            // A library may start more threads than run jobs.
            assert!(*workers == THREADS || entry.threads == Threads::Library && *workers > THREADS, "{}", entry.name);
        }
    }
}

#[test]
fn rayon_refuses_more_threads_than_it_would_start() {
    for name in ["rayon", "rayon-join", "rayon-scope"] {
        // The first thread is refused, so an error of another kind shows that no thread was requested.
        let error = find(name).and_then(|entry| entry.build(config(rayon::max_num_threads() + 1, 0)).err());
        assert!(matches!(error, Some(StrategyError::TooManyThreads { strategy, .. }) if strategy == name), "{error:?}");
    }
}
