//! Faults of entries and of threads.

use std::sync::{Arc, Barrier};
use std::thread;

use pathmark_strategy::contract::Promise;
use pathmark_strategy::{
    Amount, Blueprint, Discipline, Entry, Parameter, Sharing, Start, Stealing, Victim, Workers, block,
};

use super::{Fault, made_by, of_threads, other, runs};

/// Two disciplines that a queue of single jobs does not follow.
const DEALT: Discipline = Discipline::Dealt(|worker, workers, jobs| block(worker, workers, jobs).step_by(1));
const BLOCKS: Discipline =
    Discipline::Stealing(Stealing { start: Start::Blocks, amount: Amount::One, victim: Victim::Neighbour });

const SOUND: Entry = made_by(|blueprint| other("shared-counter", blueprint));

pub(super) const FAULTS: &[Fault] = &[
    ("a name with a blank", Promise::Name, Entry { name: "my pool", ..SOUND }),
    ("no explanation", Promise::Name, Entry { about: "", ..SOUND }),
    (
        "any parameter will do",
        Promise::Parameter,
        Entry { parameter: Some(Parameter { allowed: "all", read: |_| Some(Discipline::ONE_BY_ONE) }), ..SOUND },
    ),
    (
        "a worker too few",
        Promise::Workers,
        made_by(|Blueprint { threads, spawner, .. }| of_threads("fixed-pool", threads.get() - 1, spawner)),
    ),
    (
        "a worker too many",
        Promise::Workers,
        runs!(|broken, jobs, job| {
            let Blueprint { threads, spawner, .. } = &broken.blueprint;
            let workers = threads.get() + 1;
            // Every worker takes a job: the first jobs wait until all workers have one.
            let all = Barrier::new(workers);
            let together = move |index| {
                if jobs >= workers && index < workers {
                    all.wait();
                }
                job(index);
            };
            // A pool has all its threads before a job begins, so no job waits for a refused thread.
            of_threads("fixed-pool", workers, spawner)?.run(jobs, Arc::new(together))
        }),
    ),
    ("jobs on the caller's thread", Promise::Workers, made_by(|blueprint| other("serial", blueprint))),
    ("a worker keeps jobs to itself", Promise::Workers, made_by(|blueprint| other("dynamic:2", blueprint))),
    (
        "heartbeats that nobody hears",
        Promise::Workers,
        Entry {
            sharing: Sharing::Heartbeat,
            discipline: Discipline::Halving,
            ..made_by(|blueprint| of_threads("fixed-pool", 1, &blueprint.spawner))
        },
    ),
    (
        "another deal",
        Promise::Discipline,
        Entry { discipline: DEALT, ..made_by(|blueprint| other("static-cyclic", blueprint)) },
    ),
    (
        "no chunks",
        Promise::Discipline,
        Entry {
            discipline: Entry::chunks("halves", "of what is left", |handout| (handout.jobs - handout.start) / 2)
                .discipline,
            ..made_by(|blueprint| other("static-cyclic", blueprint))
        },
    ),
    ("a queue instead of blocks", Promise::Discipline, Entry { discipline: BLOCKS, ..SOUND }),
    (
        "the wrong way round",
        Promise::Discipline,
        Entry {
            workers: Workers::Caller,
            discipline: Discipline::InOrder,
            ..runs!(|_, jobs, job| {
                (0..jobs).rev().for_each(|index| job(index));
                Ok(())
            })
        },
    ),
    (
        "a thread is left behind",
        Promise::NoThreadLeft,
        runs!(|broken, jobs, job| {
            let forgotten = Box::new(|| {
                loop {
                    thread::park();
                }
            });
            drop(broken.blueprint.spawner.spawn("forgotten".to_owned(), forgotten));
            broken.inner.run(jobs, job)
        }),
    ),
    (
        "threads that find no job",
        Promise::NoThreadLeft,
        runs!(|broken, jobs, job| {
            for _ in jobs..broken.blueprint.threads.get() {
                let idle = broken.blueprint.spawner.spawn("idle".to_owned(), Box::new(|| ()));
                drop(idle.map(thread::JoinHandle::join));
            }
            broken.inner.run(jobs, job)
        }),
    ),
    (
        "fewer workers if one is refused",
        Promise::Refusals,
        made_by(|blueprint| {
            let threads = (1..=blueprint.threads.get()).rev();
            let made =
                threads.into_iter().find_map(|threads| of_threads("fixed-pool", threads, &blueprint.spawner).ok());
            made.map_or_else(|| other("serial", blueprint), Ok)
        }),
    ),
    (
        "a panic if one is refused",
        Promise::Refusals,
        made_by(|blueprint| Ok(other("fixed-pool", blueprint).expect("threads are there"))),
    ),
    (
        "a job runs again if a thread is refused",
        Promise::Refusals,
        runs!(|broken, jobs, job| {
            let outcome = broken.inner.run(jobs, Arc::clone(&job));
            if outcome.is_err() {
                (0..2).for_each(|_| job(0));
            }
            outcome
        }),
    ),
    (
        "another run fails after a refusal",
        Promise::Refusals,
        runs!(|broken, jobs, job| {
            if broken.panicked {
                return Ok(());
            }
            let outcome = broken.inner.run(jobs, job);
            broken.panicked = outcome.is_err();
            outcome
        }),
    ),
];
