//! A record of what ran, and a source of threads that counts them and can run dry.

use std::io;
use std::num::NonZeroUsize;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

use pathmark::strategy::{Config, Job, Spawner, SystemThreads};

use crate::watchdog::Watchdog;

/// Far more than any test takes, so that it goes off for a hang only.
const LIMIT: Duration = Duration::from_secs(20);

pub(crate) fn threads(threads: usize) -> NonZeroUsize {
    NonZeroUsize::new(threads).expect("at least one thread")
}

/// Runs `body`; a hang ends the test program with a message that names `what`.
pub(crate) fn guarded(what: &str, body: impl FnOnce()) {
    let watchdog = Watchdog::new(LIMIT);
    watchdog.now(what);
    if let Err(payload) = panic::catch_unwind(AssertUnwindSafe(body)) {
        // The payload may be a plain message: say which case it was.
        eprintln!("in {what}");
        panic::resume_unwind(payload)
    }
}

/// How often each job has run.
#[derive(Clone)]
pub(crate) struct Runs(Arc<[AtomicUsize]>);

impl Runs {
    pub(crate) fn new(jobs: usize) -> Self {
        Self((0..jobs).map(|_| AtomicUsize::new(0)).collect())
    }

    pub(crate) fn job(&self) -> Job {
        let runs = self.clone();
        Arc::new(move |index| runs.note(index))
    }

    pub(crate) fn note(&self, index: usize) {
        self.0[index].fetch_add(1, Ordering::Relaxed);
    }

    pub(crate) fn counts(&self) -> Vec<usize> {
        self.0.iter().map(|runs| runs.load(Ordering::Relaxed)).collect()
    }

    pub(crate) fn started(&self) -> usize {
        self.counts().iter().sum()
    }

    pub(crate) fn each_once(&self) -> bool {
        self.counts().iter().all(|&runs| runs == 1)
    }

    pub(crate) fn none_twice(&self) -> bool {
        self.counts().iter().all(|&runs| runs <= 1)
    }
}

/// Real threads, counted. Call number `fail_from` and the following ones up to `fail_to` are refused.
pub(crate) struct TestSpawner {
    fail_from: usize,
    fail_to: usize,
    asked: AtomicUsize,
    alive: Arc<AtomicUsize>,
}

struct Alive(Arc<AtomicUsize>);

impl Drop for Alive {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

impl TestSpawner {
    pub(crate) fn unlimited() -> Arc<Self> {
        Self::failing(usize::MAX, usize::MAX)
    }

    pub(crate) fn failing(fail_from: usize, fail_to: usize) -> Arc<Self> {
        Arc::new(Self { fail_from, fail_to, asked: AtomicUsize::new(0), alive: Arc::new(AtomicUsize::new(0)) })
    }

    pub(crate) fn config(self: &Arc<Self>, threads: NonZeroUsize) -> Config {
        Config { spawner: Arc::clone(self) as Arc<dyn Spawner>, ..Config::new(threads) }
    }

    /// How many threads have been asked for.
    pub(crate) fn asked(&self) -> usize {
        self.asked.load(Ordering::SeqCst)
    }

    /// How many threads have not ended.
    pub(crate) fn alive(&self) -> usize {
        self.alive.load(Ordering::SeqCst)
    }
}

impl Spawner for TestSpawner {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        let call = self.asked.fetch_add(1, Ordering::SeqCst);
        if (self.fail_from..self.fail_to).contains(&call) {
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
