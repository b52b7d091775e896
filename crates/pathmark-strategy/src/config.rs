//! What a strategy is made from, and where its threads come from.

use std::io;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crate::Discipline;

/// What is asked of a strategy.
#[derive(Clone)]
pub struct Config {
    /// How many workers, where the strategy asks.
    pub threads: NonZeroUsize,
    /// What follows the colon in `--strategy name:parameter`.
    pub parameter: Option<String>,
    /// Where threads come from.
    pub spawner: Arc<dyn Spawner>,
}

impl Config {
    /// `threads` real threads and no parameter.
    pub fn new(threads: NonZeroUsize) -> Self {
        Self { threads, parameter: None, spawner: Arc::new(SystemThreads) }
    }
}

/// What a strategy is made from: a [`Config`] whose parameter [`Entry::build`](crate::Entry::build) has read.
#[derive(Clone)]
pub struct Blueprint {
    /// The strategy's name, for its errors.
    pub strategy: &'static str,
    /// How it shall hand out jobs.
    pub discipline: Discipline,
    /// How many workers it shall have, unless it ignores that.
    pub threads: NonZeroUsize,
    /// Where its threads come from.
    pub spawner: Arc<dyn Spawner>,
}

/// Where threads come from; a test puts one here that runs out of them.
pub trait Spawner: Send + Sync {
    /// Starts a thread called `name` that runs `body`.
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>>;
}

/// Bytes of stack for a worker of a program that is most likely not optimised: where nothing shares a place on the stack, a SIMD kernel takes
/// 3 MiB of it and Rust's threads have 2 MiB.
const UNOPTIMISED_STACK: usize = 16 << 20;

/// Threads of the operating system. Their stacks are Rust's own (`RUST_MIN_STACK`, or 2 MiB), and 16 MiB in builds with debug assertions.
#[derive(Debug, Clone, Copy)]
pub struct SystemThreads;

impl Spawner for SystemThreads {
    fn spawn(&self, name: String, body: Box<dyn FnOnce() + Send + 'static>) -> io::Result<JoinHandle<()>> {
        let builder = thread::Builder::new().name(name);
        let builder = if cfg!(debug_assertions) { builder.stack_size(UNOPTIMISED_STACK) } else { builder };
        builder.spawn(body)
    }
}
