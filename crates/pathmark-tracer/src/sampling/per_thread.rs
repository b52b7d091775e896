//! A PCG32 generator for each thread: `--sampler per-thread`.
//!
//! The usual replacement for a shared generator: no thread waits. But a pixel's numbers depend on the thread that
//! renders it. So no two runs with more than one thread are alike, and rendering a pixel again does not reproduce an
//! error. This sampler exists to be measured, not to be used.

use super::{Address, Sampler, mix};
use crate::math::unit;
use rand::Rng;
use rand_pcg::Pcg32;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};

#[derive(Debug)]
pub struct PerThread {
    seed: u64,
    /// Distinguishes this sampler's generators from those that an earlier sampler left in a pool's threads.
    id: u64,
    threads: AtomicU64,
    /// How far the streams of two threads lie apart.
    step: u64,
}

thread_local! {
    static GENERATOR: RefCell<(u64, Pcg32)> = RefCell::new((0, Pcg32::new(0, 0)));
}

impl PerThread {
    /// Creates a sampler with this seed and one generator stream per thread.
    pub fn new(seed: u64) -> Self {
        Self::stepping(seed, 1)
    }

    /// Creates a sampler whose threads have streams at this distance; with 0, all have the same.
    pub(super) fn stepping(seed: u64, step: u64) -> Self {
        static SAMPLERS: AtomicU64 = AtomicU64::new(1);
        Self { seed, id: SAMPLERS.fetch_add(1, Ordering::Relaxed), threads: AtomicU64::new(0), step }
    }
}

impl Sampler for PerThread {
    fn pair(&self, _: Address) -> [f64; 2] {
        GENERATOR.with_borrow_mut(|(owner, generator)| {
            if *owner != self.id {
                *owner = self.id;
                let stream = self.threads.fetch_add(self.step, Ordering::Relaxed);
                // Streams from one state are correlated, so each stream starts in a state of its own.
                *generator = Pcg32::new(mix(self.seed ^ mix(stream)), stream);
            }
            [(); 2].map(|()| unit(generator.next_u64()))
        })
    }
}
