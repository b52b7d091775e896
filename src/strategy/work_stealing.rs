//! Work stealing: each worker has a queue of its own, and one whose queue is empty helps itself elsewhere.
//!
//! `pathmark render cornell --strategy work-stealing --threads 4`
//!
//! Blumofe and Leiserson, "Scheduling multithreaded computations by work stealing", JACM 46(5), 1999; the queues are the deques of
//! Chase and Lev, "Dynamic circular work-stealing deque", SPAA 2005, as `crossbeam-deque` has them. All jobs start in one shared
//! injector. A worker takes its next job from its own deque, else a batch from the injector, else half of another worker's deque,
//! asking its neighbours in turn.
//!
//! Cost: one thread's start for each worker, a push into the injector for each job before that, then mostly operations on the
//! worker's own cache lines. Other workers' lines are touched once a batch.

use std::iter;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crossbeam::deque::{Injector, Steal, Stealer, Worker};
use crossbeam::utils::{Backoff, CachePadded};

use super::team::{self, Panics};
use super::{
    Amount, Config, Discipline, Entry, Job, Sharing, Start, Stealing, Strategy, StrategyError, Threads, Victim,
    Workers, unless_set,
};

pub(super) const ENTRY: Entry = Entry {
    name: "work-stealing",
    about: "a deque for each worker; whoever runs dry steals from the others",
    workers: Workers::Threads,
    threads: Threads::Spawner,
    sharing: Sharing::AtOnce,
    discipline,
    new,
};

fn discipline(parameter: Option<&str>) -> Result<Discipline, StrategyError> {
    // Crossbeam moves half of a queue at a time, up to 32 jobs.
    let stealing = Stealing { start: Start::Shared(32), amount: Amount::Half, victim: Victim::Neighbour };
    unless_set(ENTRY.name, parameter, Discipline::Stealing(stealing))
}

fn new(config: Config) -> Result<Box<dyn Strategy>, StrategyError> {
    config.discipline(&ENTRY)?;
    Ok(Box::new(WorkStealing(config)))
}

struct WorkStealing(Config);

impl Strategy for WorkStealing {
    fn run(&mut self, jobs: usize, job: Job) -> Result<(), StrategyError> {
        let deques: Vec<_> = (0..self.0.threads.get().min(jobs)).map(|_| Worker::new_lifo()).collect();
        let shared = Arc::new(Shared {
            jobs,
            injector: Injector::new(),
            stealers: deques.iter().map(Worker::stealer).collect(),
            taken: deques.iter().map(|_| CachePadded::default()).collect(),
        });
        (0..jobs).for_each(|index| shared.injector.push(index));
        let bodies = deques.into_iter().enumerate().map(|(worker, deque)| {
            let (job, shared) = (Arc::clone(&job), Arc::clone(&shared));
            move |panics: &Panics| shared.work(worker, &deque, &job, panics)
        });
        team::run(&*self.0.spawner, bodies)
    }
}

/// What the workers of one run share.
struct Shared {
    jobs: usize,
    injector: Injector<usize>,
    stealers: Box<[Stealer<usize>]>,
    /// How many jobs each worker has taken to run. One counter each, since one for all would be the shared counter again.
    taken: Box<[CachePadded<AtomicUsize>]>,
}

impl Shared {
    fn work(&self, worker: usize, deque: &Worker<usize>, job: &Job, panics: &Panics) {
        let mut taken = 0;
        let backoff = Backoff::new();
        while !panics.stop_asked() {
            if let Some(index) = deque.pop().or_else(|| self.steal(worker, deque)) {
                taken += 1;
                self.taken[worker].store(taken, Ordering::Relaxed);
                job(index);
                backoff.reset();
            } else if self.all_taken() {
                break;
            } else {
                backoff.snooze();
            }
        }
    }

    /// A job from elsewhere; what comes with it goes into `deque`, where others can steal it while this worker is busy.
    fn steal(&self, thief: usize, deque: &Worker<usize>) -> Option<usize> {
        let (before, after) = self.stealers.split_at(thief);
        let victims = after.iter().skip(1).chain(before).map(|victim| victim.steal_batch_and_pop(deque));
        iter::once_with(|| self.injector.steal_batch_and_pop(deque)).chain(victims).find_map(Steal::success)
    }

    /// Whether there is nothing left to find. That every queue looks empty doesn't say so: a batch on its way from one to another
    /// is in neither, and a worker that left then would be missing when the thief is held up in its first job. Who has to wait
    /// here waits for a batch to arrive, never for a job to end.
    fn all_taken(&self) -> bool {
        self.taken.iter().map(|taken| taken.load(Ordering::Relaxed)).sum::<usize>() == self.jobs
    }
}

#[cfg(test)]
mod tests {
    use super::{AtomicUsize, CachePadded, Injector, Ordering, Shared, Worker};

    #[test]
    fn a_batch_on_its_way_keeps_workers_waiting() {
        let deques: [Worker<usize>; 2] = [Worker::new_lifo(), Worker::new_lifo()];
        // Two jobs that are in no queue, as between leaving one and arriving in the next.
        let shared = Shared {
            jobs: 2,
            injector: Injector::new(),
            stealers: deques.iter().map(Worker::stealer).collect(),
            taken: (0..2).map(|_| CachePadded::new(AtomicUsize::new(0))).collect(),
        };
        assert!(!shared.all_taken());
        shared.taken[0].store(1, Ordering::Relaxed);
        assert!(!shared.all_taken());
        shared.taken[1].store(1, Ordering::Relaxed);
        assert!(shared.all_taken());
    }
}
