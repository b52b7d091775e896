//! A `SplitMix64` generator for each thread, each on cache lines of its own: `--sampler padded`.
//!
//! The states lie in one array, as in many programs that have an entry for each thread. The distance of two entries keeps
//! them on different cache lines, so a thread that writes its state takes no line from another one. Beside `unpadded`, which
//! differs in the distance alone, this shows the price of false sharing. The numbers of a pixel depend on its thread, so the
//! sampler is measured and not used.

use super::racy::next;
use super::{Address, Sampler, mix};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

/// Words of two cache lines: processors may fetch lines in pairs.
const APART: usize = 16;

/// The largest number of threads that a run may have. Threads that come later take the places of ended ones.
const PLACES: usize = 16_384;

/// The sampler.
#[derive(Debug)]
pub struct Padded {
    states: Box<[AtomicU64]>,
    /// Words from one state to the next.
    apart: usize,
    seed: u64,
    /// Distinguishes this sampler's threads from those of an earlier sampler in the same pool.
    id: u64,
    threads: AtomicU64,
}

thread_local! {
    /// The sampler to which the thread belongs, and the place of its state.
    static PLACE: Cell<(u64, usize)> = const { Cell::new((0, 0)) };
}

impl Padded {
    /// Creates a sampler with this seed and a state per thread.
    pub fn new(seed: u64) -> Self {
        Self::apart(seed, APART)
    }

    /// Creates a sampler whose states lie this many words apart.
    pub(super) fn apart(seed: u64, apart: usize) -> Self {
        static SAMPLERS: AtomicU64 = AtomicU64::new(1);
        let states = (0..PLACES * apart).map(|_| AtomicU64::new(0)).collect();
        Self { states, apart, seed, id: SAMPLERS.fetch_add(1, Ordering::Relaxed), threads: AtomicU64::new(0) }
    }

    /// The state of a thread that draws its first number.
    fn begin(&self) -> usize {
        let thread = self.threads.fetch_add(1, Ordering::Relaxed);
        let place = (thread as usize % PLACES) * self.apart;
        self.states[place].store(mix(self.seed ^ mix(thread)), Ordering::Relaxed);
        PLACE.set((self.id, place));
        place
    }
}

impl Sampler for Padded {
    fn pair(&self, _: Address) -> [f64; 2] {
        let (owner, place) = PLACE.get();
        let place = if owner == self.id { place } else { self.begin() };
        [(); 2].map(|()| next(&self.states[place]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Purpose, SampleKey};

    /// A cache line has 64 bytes, of which each state takes 8.
    #[test]
    fn states_lie_apart_or_side_by_side() {
        let places = |sampler: &Padded| [(); 3].map(|()| sampler.begin());
        assert_eq!(places(&Padded::new(1)).map(|place| 8 * place), [0, 128, 256]);
        assert_eq!(places(&Padded::apart(1, 1)).map(|place| 8 * place), [0, 8, 16]);
    }

    /// The distance of the states is all in which the two samplers differ.
    #[test]
    fn the_distance_changes_no_number() {
        let at =
            Address { key: SampleKey { seed: 1, pixel: 0, sample: 0 }, bounce: 0, branch: 0, purpose: Purpose::Film };
        let numbers = |sampler: &Padded| (0..1000).map(|_| sampler.pair(at)).collect::<Vec<[f64; 2]>>();
        let [padded, unpadded] = [Padded::new(7), Padded::apart(7, 1)];
        let first = numbers(&padded);
        assert_eq!(first, numbers(&unpadded));
        // The sampler that was used last owns the thread's place, so the thread begins anew.
        assert_ne!(first, numbers(&padded));
    }
}
