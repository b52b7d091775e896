//! Work stealing: a worker takes from its own queue first, then from the shared one if there is any, then from another
//! worker's.
//!
//! A worker fills its queue only when it is empty, so a queue is always one contiguous range. The owner takes its first
//! job, a thief its last ones. Moving jobs takes no extra time (a stolen job costs [`Overhead::job_s`] like any other).
//! A worker that finds no job anywhere can stop, since jobs create no new jobs.
//!
//! [`Overhead::job_s`]: crate::simulate::Overhead::job_s

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::ops::Range;

use rand::Rng;
use rand_pcg::Pcg32;

use super::crew::Crew;
use crate::strategy::{Amount, Start, Stealing, Victim, block};

pub(super) fn run(crew: &mut Crew<'_>, stealing: Stealing) {
    let mut queues = Queues::new(stealing, crew.workers(), crew.jobs());
    while let Some((worker, mut now_s)) = crew.next_free() {
        if queues.own[worker].is_empty() {
            let batch = queues.take_shared();
            if batch.is_empty() {
                queues.steal(worker);
            } else {
                now_s = crew.through_shared_place(worker, batch.len(), now_s);
                queues.put(worker, batch);
            }
        }
        let job = queues.pop(worker);
        let free_s = crew.work(worker, job, now_s);
        if job.is_some() {
            crew.ask_again(worker, free_s);
        }
    }
}

struct Queues {
    stealing: Stealing,
    shared: Range<usize>,
    own: Vec<Range<usize>>,
    filled: BTreeSet<usize>,
    /// The same workers, the longest queue last; of equal lengths, the first worker's is last. Kept only for
    /// `Victim::Richest`.
    by_length: BTreeSet<(usize, Reverse<usize>)>,
    random: Pcg32,
}

impl Queues {
    fn new(stealing: Stealing, workers: usize, jobs: usize) -> Self {
        let mut queues = Self {
            stealing,
            shared: 0..0,
            own: vec![0..0; workers],
            filled: BTreeSet::new(),
            by_length: BTreeSet::new(),
            random: Pcg32::new(jobs as u64, workers as u64),
        };
        match stealing.start {
            Start::Shared(_) => queues.shared = 0..jobs,
            Start::Blocks => {
                for worker in 0..workers {
                    queues.put(worker, block(worker, workers, jobs));
                }
            }
        }
        queues
    }

    /// Takes half of the shared queue, up to the batch's size.
    fn take_shared(&mut self) -> Range<usize> {
        let most = match self.stealing.start {
            Start::Shared(most) => most.max(1),
            Start::Blocks => 0,
        };
        let start = self.shared.start;
        self.shared.start += self.shared.len().div_ceil(2).min(most);
        start..self.shared.start
    }

    fn put(&mut self, worker: usize, range: Range<usize>) {
        if range.is_empty() {
            self.filled.remove(&worker);
        } else {
            self.filled.insert(worker);
        }
        if self.stealing.victim == Victim::Richest {
            self.by_length.remove(&(self.own[worker].len(), Reverse(worker)));
            if !range.is_empty() {
                self.by_length.insert((range.len(), Reverse(worker)));
            }
        }
        self.own[worker] = range;
    }

    fn pop(&mut self, worker: usize) -> Option<usize> {
        let Range { start, end } = self.own[worker];
        (start < end).then(|| {
            self.put(worker, start + 1..end);
            start
        })
    }

    fn steal(&mut self, thief: usize) {
        let Some(victim) = self.victim(thief) else { return };
        let Range { start, end } = self.own[victim];
        let amount = match self.stealing.amount {
            Amount::One => 1,
            Amount::Half => (end - start).div_ceil(2),
        };
        self.put(victim, start..end - amount);
        self.put(thief, end - amount..end);
    }

    fn victim(&mut self, thief: usize) -> Option<usize> {
        let first = match self.stealing.victim {
            Victim::Richest => return self.by_length.last().map(|&(_, Reverse(worker))| worker),
            Victim::Neighbour => thief + 1,
            // The product's high half is less than the number of workers.
            Victim::Random => ((u64::from(self.random.next_u32()) * self.own.len() as u64) >> 32) as usize,
        };
        self.filled.range(first..).chain(&self.filled).next().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queues(start: Start, amount: Amount, victim: Victim, workers: usize, jobs: usize) -> Queues {
        Queues::new(Stealing { start, amount, victim }, workers, jobs)
    }

    #[test]
    fn batches_from_the_shared_queue() {
        let mut queues = queues(Start::Shared(4), Amount::Half, Victim::Neighbour, 2, 11);
        let sizes: Vec<usize> = (0..6).map(|_| queues.take_shared().len()).collect();
        assert_eq!(sizes, [4, 4, 2, 1, 0, 0]);
    }

    #[test]
    fn thieves_find_their_victims() {
        let mut richest = queues(Start::Blocks, Amount::Half, Victim::Richest, 3, 11);
        assert_eq!(richest.own, [0..4, 4..8, 8..11]);
        assert_eq!([richest.pop(0), richest.pop(0)], [Some(0), Some(1)]);
        assert_eq!(richest.victim(2), Some(1));
        richest.put(2, 0..0);
        richest.steal(2);
        assert_eq!(richest.own, [2..4, 4..6, 6..8]);

        let mut neighbour = queues(Start::Blocks, Amount::One, Victim::Neighbour, 3, 9);
        neighbour.put(2, 0..0);
        assert_eq!(neighbour.victim(1), Some(0));
        neighbour.put(1, 0..0);
        neighbour.steal(1);
        assert_eq!(neighbour.own, [0..2, 2..3, 0..0]);
    }
}
