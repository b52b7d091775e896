//! A strategy's configuration, and the source of its threads.

use std::io;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crate::{Discipline, Workers};

/// The configuration of a strategy.
#[derive(Clone)]
pub struct Config {
    /// Number of workers; some strategies ignore it.
    pub threads: NonZeroUsize,
    /// The text after the colon in `--strategy name:parameter`.
    pub parameter: Option<String>,
    /// The source of threads.
    pub spawner: Arc<dyn Spawner>,
}

impl Config {
    /// Returns a configuration with `threads` threads of the operating system and no parameter.
    pub fn new(threads: NonZeroUsize) -> Self {
        Self { threads, parameter: None, spawner: Arc::new(SystemThreads) }
    }
}

/// The input for making a strategy: a [`Config`] whose parameter [`Entry::build`](crate::Entry::build) has parsed.
#[derive(Clone)]
pub struct Blueprint {
    /// The strategy's name, for its error messages.
    pub strategy: &'static str,
    /// How the strategy hands out jobs.
    pub discipline: Discipline,
    /// Number of workers; some strategies ignore it.
    pub threads: NonZeroUsize,
    /// The source of its threads.
    pub spawner: Arc<dyn Spawner>,
}

impl Blueprint {
    /// Returns the number of workers for so many jobs.
    pub fn workers(&self, jobs: usize) -> usize {
        Workers::Threads.at_once(self.threads.get(), jobs)
    }
}

/// A source of threads; a test can use one that runs out of threads.
pub trait Spawner: Send + Sync {
    /// Starts a thread called `name` that runs `body`.
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>>;
}

/// Stack size in bytes for a worker in a build that is most likely not optimised. Without optimisation variables share
/// no stack slots, so a SIMD kernel needs 3 MiB of stack; Rust's threads have 2 MiB.
const UNOPTIMISED_STACK: usize = 16 << 20;

/// Threads of the operating system. Their stack size is Rust's default (`RUST_MIN_STACK`, or 2 MiB), and 16 MiB in
/// builds with debug assertions.
#[derive(Debug, Clone, Copy)]
pub struct SystemThreads;

impl Spawner for SystemThreads {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        let builder = thread::Builder::new().name(name);
        let builder = if cfg!(debug_assertions) { builder.stack_size(UNOPTIMISED_STACK) } else { builder };
        builder.spawn(body)
    }
}
