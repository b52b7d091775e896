//! Recursive halving: a worker that takes a range puts second halves aside until one job is left, and runs that job.
//!
//! The worker continues with the half that it put aside last, its smallest. A worker without halves takes the largest
//! one of all workers, which is its victim's first. Ranges are halved as soon as they are taken, so a worker that finds
//! no half can stop: none will appear later.

use std::cmp::Reverse;
use std::collections::{BTreeSet, VecDeque};
use std::ops::Range;

use super::crew::Crew;

pub(super) fn run(crew: &mut Crew<'_>) {
    let mut halves = Halves { aside: vec![VecDeque::new(); crew.workers()], largest: BTreeSet::new() };
    let mut whole = Some(0..crew.jobs()).filter(|range| !range.is_empty());
    while let Some((worker, now_s)) = crew.next_free() {
        let range = whole.take().or_else(|| halves.take(worker));
        let job = range.map(|range| halves.split(worker, range));
        let free_s = crew.work(worker, job, now_s);
        if job.is_some() {
            crew.ask_again(worker, free_s);
        }
    }
}

struct Halves {
    /// The halves that each worker has put aside, the largest in front.
    aside: Vec<VecDeque<Range<usize>>>,
    /// The length of each worker's largest half, for workers that have any; of equal lengths, the first worker's is
    /// last.
    largest: BTreeSet<(usize, Reverse<usize>)>,
}

impl Halves {
    fn key(&self, worker: usize) -> Option<(usize, Reverse<usize>)> {
        self.aside[worker].front().map(|range| (range.len(), Reverse(worker)))
    }

    /// Takes the range with which `worker` continues.
    fn take(&mut self, worker: usize) -> Option<Range<usize>> {
        let own = self.key(worker);
        let (victim, key) = match own {
            Some(key) => (worker, key),
            None => self.largest.last().map(|&key| (key.1.0, key))?,
        };
        self.largest.remove(&key);
        let range = if own.is_some() { self.aside[victim].pop_back() } else { self.aside[victim].pop_front() };
        self.largest.extend(self.key(victim));
        range
    }

    /// Puts second halves of `range` aside until one job is left.
    fn split(&mut self, worker: usize, range: Range<usize>) -> usize {
        let Range { start, mut end } = range;
        let before = self.key(worker);
        while end - start > 1 {
            let middle = start + (end - start) / 2;
            self.aside[worker].push_back(middle..end);
            end = middle;
        }
        if before.is_none() {
            self.largest.extend(self.key(worker));
        }
        start
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn owner_takes_the_smallest_and_a_thief_the_largest() {
        let mut halves = Halves { aside: vec![VecDeque::new(); 3], largest: BTreeSet::new() };
        assert_eq!(halves.split(0, 0..8), 0);
        assert_eq!(halves.aside[0], [4..8, 2..4, 1..2]);
        assert_eq!(halves.take(0), Some(1..2));
        let stolen = halves.take(1);
        assert_eq!(stolen, Some(4..8));
        assert_eq!(halves.split(1, 4..8), 4);
        assert_eq!(halves.aside[1], [6..8, 5..6]);
        // Both workers have two jobs in front: the first worker's are taken first.
        assert_eq!(halves.take(2), Some(2..4));
        assert_eq!(halves.take(2), Some(6..8));
        assert_eq!(halves.take(2), Some(5..6));
        assert_eq!(halves.take(2), None);
    }
}
