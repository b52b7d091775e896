//! The bare mechanisms of strategies: the same primitive, a job that is known at compile time, and no handling of
//! panics.
//!
//! The difference between such a loop and the strategy is the overhead of the interface between scheduling and work: a
//! call through `Arc<dyn Fn>`, a check of the stop request, and catching panics. Threads are started where the strategy
//! starts them, in the run or before it.

use std::collections::VecDeque;
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crossbeam::channel::{self, Receiver};
use crossbeam::deque::{Injector, Steal, Worker};
use crossbeam::sync::WaitGroup;
use crossbeam::utils::CachePadded;
use rayon::ThreadPoolBuilder;
use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

/// A function that runs the given number of jobs.
pub(crate) type Run = Box<dyn FnMut(usize)>;

/// A function that makes a mechanism for a number of threads.
pub(crate) type Make = fn(usize) -> Run;

/// The strategies with their bare mechanisms.
pub(crate) const PAIRS: [(&str, Make); 6] = [
    ("serial", plain_loop),
    ("shared-counter", counter),
    ("mutex-queue", mutex_queue),
    ("work-stealing", injector),
    ("rayon", parallel_iterator),
    ("fixed-pool", queue),
];

/// The empty job.
pub(crate) fn empty(index: usize) {
    black_box(index);
}

fn plain_loop(_: usize) -> Run {
    Box::new(|jobs| (0..jobs).for_each(empty))
}

/// Runs `body` on `threads` new threads.
fn scoped(threads: usize, body: impl Fn() + Sync) {
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(&body);
        }
    });
}

fn counter(threads: usize) -> Run {
    Box::new(move |jobs| {
        let next = CachePadded::new(AtomicUsize::new(0));
        scoped(threads, || {
            while let Some(index) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|index| *index < jobs) {
                empty(index);
            }
        });
    })
}

fn mutex_queue(threads: usize) -> Run {
    Box::new(move |jobs| {
        let queue: Mutex<VecDeque<usize>> = Mutex::new((0..jobs).collect());
        let take = || queue.lock().unwrap_or_else(PoisonError::into_inner).pop_front();
        scoped(threads, || {
            while let Some(index) = take() {
                empty(index);
            }
        });
    })
}

fn injector(threads: usize) -> Run {
    Box::new(move |jobs| {
        let injector = Injector::new();
        (0..jobs).for_each(|index| injector.push(index));
        scoped(threads, || {
            let deque = Worker::new_lifo();
            loop {
                let stolen = || match injector.steal_batch_and_pop(&deque) {
                    Steal::Success(index) => Some(index),
                    Steal::Empty | Steal::Retry => None,
                };
                match deque.pop().or_else(stolen) {
                    Some(index) => empty(index),
                    None if injector.is_empty() => break,
                    None => {}
                }
            }
        });
    })
}

fn parallel_iterator(threads: usize) -> Run {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    Box::new(move |jobs| pool.install(|| (0..jobs).into_par_iter().with_max_len(1).for_each(empty)))
}

/// Threads that live as long as the closure, and a bounded channel for each run.
fn queue(threads: usize) -> Run {
    let (rounds, calls) = channel::unbounded::<(Receiver<usize>, WaitGroup)>();
    for _ in 0..threads {
        let calls = calls.clone();
        thread::spawn(move || {
            for (indices, done) in calls {
                indices.iter().for_each(empty);
                drop(done);
            }
        });
    }
    Box::new(move |jobs| {
        let done = WaitGroup::new();
        let (feed, indices) = channel::bounded(4096);
        for _ in 0..threads {
            rounds.send((indices.clone(), done.clone())).expect("the threads wait for more");
        }
        for index in 0..jobs {
            feed.send(index).expect("an end is held here");
        }
        drop(feed);
        done.wait();
    })
}
