//! A range of jobs for each worker, from which the worker takes the first and others steal the last.
//!
//! A range is one 64-bit word: its start above, its end below. Every change is one compare-exchange of the word, so no job can be in
//! two ranges. Such schemes usually fear ABA, a word that has changed and changed back between reading and exchanging it. Here that does
//! no harm: the word is the whole state, and if it is the same again then the same jobs are there again.

use std::ops::Range;

use super::sync::{AtomicU64, CachePadded, Ordering};

/// The jobs that nobody has taken yet, by worker.
///
/// Relaxed orderings suffice. The jobs' numbers alone are shared out here, and all of them are in the word; what jobs write is published
/// by joining the threads.
pub(super) struct Ranges(Box<[CachePadded<AtomicU64>]>);

impl Ranges {
    /// One range for each worker.
    pub(super) fn new(ranges: impl Iterator<Item = Range<u32>>) -> Self {
        Self(ranges.map(|range| CachePadded::new(AtomicU64::new(pack(&range)))).collect())
    }

    /// How many workers there are.
    pub(super) fn workers(&self) -> usize {
        self.0.len()
    }

    /// How many jobs `worker` has left. Another number may be true by now.
    pub(super) fn left(&self, worker: usize) -> u32 {
        unpack(self.0[worker].load(Ordering::Relaxed)).len() as u32
    }

    /// The first of `worker`'s own jobs.
    pub(super) fn pop(&self, worker: usize) -> Option<u32> {
        self.split(worker, |_| 1, true).map(|popped| popped.start)
    }

    /// The last jobs of `victim`, as many as `amount` says of those that are left. The first of them is returned and the others become
    /// `thief`'s range, which must be empty and which only `thief` may refill.
    pub(super) fn steal(&self, thief: usize, victim: usize, amount: fn(u32) -> u32) -> Option<u32> {
        let stolen = self.split(victim, amount, false)?;
        // A store is enough: nobody exchanges an empty range for anything.
        self.0[thief].store(pack(&(stolen.start + 1..stolen.end)), Ordering::Relaxed);
        Some(stolen.start)
    }

    /// Takes so many of `worker`'s jobs off one end, in one step; `None` if there is none.
    fn split(&self, worker: usize, amount: impl Fn(u32) -> u32, front: bool) -> Option<Range<u32>> {
        let word = &self.0[worker];
        let mut seen = word.load(Ordering::Relaxed);
        loop {
            let Range { start, end } = unpack(seen);
            if start == end {
                return None;
            }
            let amount = amount(end - start);
            let (taken, left) = if front {
                (start..start + amount, start + amount..end)
            } else {
                (end - amount..end, start..end - amount)
            };
            match word.compare_exchange_weak(seen, pack(&left), Ordering::Relaxed, Ordering::Relaxed) {
                Ok(_) => return Some(taken),
                Err(now) => seen = now,
            }
        }
    }
}

fn pack(range: &Range<u32>) -> u64 {
    u64::from(range.start) << 32 | u64::from(range.end)
}

fn unpack(word: u64) -> Range<u32> {
    (word >> 32) as u32..word as u32
}
