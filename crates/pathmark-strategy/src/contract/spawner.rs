//! A source of threads that counts them and can refuse them.

use std::io;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;

use crate::{Spawner, SystemThreads};

/// A spawner of real threads that counts them. It refuses the calls whose numbers are in a range.
pub(super) struct CountedThreads {
    refused: Range<usize>,
    asked: AtomicUsize,
    refusals: AtomicUsize,
    alive: Arc<AtomicUsize>,
}

struct Alive(Arc<AtomicUsize>);

impl Drop for Alive {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

impl CountedThreads {
    pub(super) fn unlimited() -> Arc<Self> {
        Self::refusing(0..0)
    }

    pub(super) fn refusing(refused: Range<usize>) -> Arc<Self> {
        Arc::new(Self { refused, asked: AtomicUsize::new(0), refusals: AtomicUsize::new(0), alive: Arc::default() })
    }

    /// Returns how many threads have been requested.
    pub(super) fn asked(&self) -> usize {
        self.asked.load(Ordering::SeqCst)
    }

    /// Returns how many threads have been refused.
    pub(super) fn refusals(&self) -> usize {
        self.refusals.load(Ordering::SeqCst)
    }

    /// Checks that no thread is alive. The caller must have dropped the strategy.
    pub(super) fn none_left(&self) -> Result<(), String> {
        match self.alive.load(Ordering::SeqCst) {
            0 => Ok(()),
            left => Err(format!("{left} threads are left when the strategy has been dropped")),
        }
    }
}

impl Spawner for CountedThreads {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        let call = self.asked.fetch_add(1, Ordering::SeqCst);
        if self.refused.contains(&call) {
            self.refusals.fetch_add(1, Ordering::SeqCst);
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.alive.fetch_add(1, Ordering::SeqCst);
        let alive = Alive(Arc::clone(&self.alive));
        SystemThreads.spawn(
            name,
            Box::new(move || {
                let _alive = alive;
                body();
            }),
        )
    }
}
