//! A range of jobs for each worker: the worker takes the first job, and thieves steal the last ones.
//!
//! A range is one 64-bit word: its start in the high half, its end in the low half. Jobs are taken by one
//! compare-exchange of the word, so no job can be in two ranges. The ABA problem (a word changes and changes back
//! between read and exchange) is harmless here: the word is the whole state, so an equal word means the same jobs.

use std::ops::Range;

use super::sync::{AtomicU64, CachePadded, Ordering};

/// The jobs that no worker has taken yet, by worker.
///
/// Relaxed orderings suffice: only job numbers are shared, and the word holds all of them. Joining the threads
/// publishes the data that jobs write.
pub(super) struct Ranges(Box<[CachePadded<AtomicU64>]>);

impl Ranges {
    /// Creates one range for each worker.
    pub(super) fn new(ranges: impl Iterator<Item = Range<u32>>) -> Self {
        Self(ranges.map(|range| CachePadded::new(AtomicU64::new(pack(&range)))).collect())
    }

    /// Returns the number of workers.
    pub(super) fn workers(&self) -> usize {
        self.0.len()
    }

    /// Returns the number of jobs that `worker` has left. It may have changed already.
    pub(super) fn left(&self, worker: usize) -> u32 {
        unpack(self.0[worker].load(Ordering::Relaxed)).len() as u32
    }

    /// Takes the first of `worker`'s own jobs.
    pub(super) fn pop(&self, worker: usize) -> Option<u32> {
        self.split(worker, |_| 1, true).map(|popped| popped.start)
    }

    /// Steals the last jobs of `victim`; `amount` computes their number from the number of jobs left. Returns the first
    /// stolen job. The others become `thief`'s range, which must be empty and which only `thief` may refill.
    pub(super) fn steal(&self, thief: usize, victim: usize, amount: fn(u32) -> u32) -> Option<u32> {
        let stolen = self.split(victim, amount, false)?;
        // A store suffices: no other worker changes an empty range.
        self.0[thief].store(pack(&(stolen.start + 1..stolen.end)), Ordering::Relaxed);
        Some(stolen.start)
    }

    /// Takes jobs off one end of `worker`'s range in one atomic step; `None` if the range is empty.
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
