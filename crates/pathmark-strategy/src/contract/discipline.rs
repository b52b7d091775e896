//! Discipline: a strategy hands out jobs as it says, as far as a test from outside can show it without luck.

use std::collections::{BTreeSet, HashMap};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use super::case::{Case, run};
use super::meeting::Meeting;
use crate::{ChunkRule, Deal, Discipline, Sharing, Start, block};

pub(super) fn as_told(case: &Case) -> Result<(), String> {
    let discipline = case.entry.discipline(case.contract.parameter.as_deref()).map_err(|error| error.to_string())?;
    for threads in case.threads() {
        match discipline {
            Discipline::InOrder => in_order(case, threads)?,
            Discipline::Dealt(deal) => dealt(case, threads, deal)?,
            Discipline::Chunks(rule) => in_chunks(case, threads, rule)?,
            Discipline::Learned(_) => ascending(case, threads)?,
            Discipline::Stealing(stealing) if stealing.start == Start::Blocks => from_blocks(case, threads)?,
            // Which worker gets which job depends on the time of requests.
            Discipline::Stealing(_) | Discipline::Halving | Discipline::AllAtOnce => {}
        }
    }
    Ok(())
}

/// Runs jobs that call `then`, and returns the jobs of each thread in the order in which they ran.
fn by_thread(
    case: &Case,
    threads: usize,
    jobs: usize,
    then: impl Fn(usize) + Send + Sync + 'static,
) -> Result<HashMap<ThreadId, Vec<usize>>, String> {
    case.at(format!("{threads} threads, {jobs} jobs"));
    let hands = Arc::new(Mutex::new(HashMap::<ThreadId, Vec<usize>>::new()));
    let noted = Arc::clone(&hands);
    let job = move |index| {
        noted.lock().unwrap_or_else(PoisonError::into_inner).entry(thread::current().id()).or_default().push(index);
        then(index);
    };
    run(&mut *case.ready(threads)?, jobs, Arc::new(job))?;
    let mut hands = hands.lock().unwrap_or_else(PoisonError::into_inner);
    Ok(std::mem::take(&mut *hands))
}

fn in_order(case: &Case, threads: usize) -> Result<(), String> {
    let hands = by_thread(case, threads, 50, |_| ())?;
    if !hands.into_values().eq([(0..50).collect::<Vec<_>>()]) {
        return Err("the jobs do not run in order on one thread".to_owned());
    }
    Ok(())
}

/// The first jobs of all workers wait for each other, so that no thread can take over another worker's share.
fn dealt(case: &Case, threads: usize, deal: Deal) -> Result<(), String> {
    const JOBS: usize = 103;
    let shares: BTreeSet<BTreeSet<usize>> = (0..threads)
        .map(|worker| deal(worker, threads, JOBS).collect())
        .filter(|share: &BTreeSet<_>| !share.is_empty())
        .collect();
    let firsts: BTreeSet<usize> = shares.iter().filter_map(|share| share.first().copied()).collect();
    let meeting = Meeting::of_first(case, firsts.len());
    let wait = move |index| {
        if firsts.contains(&index) {
            meeting.wait(index);
        }
    };
    let hands = by_thread(case, threads, JOBS, wait)?;
    let found: BTreeSet<BTreeSet<usize>> = hands.into_values().map(BTreeSet::from_iter).collect();
    match found.difference(&shares).next() {
        Some(other) => Err(format!("a worker ran the jobs {other:?}, a set that the deal gives to no worker")),
        None => Ok(()),
    }
}

/// Each chunk must run on one thread, job after job. Any thread may take it, at any time.
fn in_chunks(case: &Case, threads: usize, rule: ChunkRule) -> Result<(), String> {
    const JOBS: usize = 1000;
    let hands = by_thread(case, threads, JOBS, |_| ())?;
    let places: HashMap<usize, (ThreadId, usize)> = hands
        .iter()
        .flat_map(|(&thread, jobs)| jobs.iter().enumerate().map(move |(place, &job)| (job, (thread, place))))
        .collect();
    let together = |chunk: &Range<usize>| {
        let start = places.get(&chunk.start).copied();
        start.is_some_and(|(thread, place)| {
            chunk.clone().enumerate().all(|(after, job)| places.get(&job) == Some(&(thread, place + after)))
        })
    };
    match rule.chunks(JOBS, threads).find(|chunk| !together(chunk)) {
        Some(chunk) => Err(format!("the jobs {chunk:?} are a chunk, but no thread ran them one after the other")),
        None => Ok(()),
    }
}

/// Chunks of one range are handed out in order, so the jobs of each worker must ascend. Their sizes depend on the
/// clock.
fn ascending(case: &Case, threads: usize) -> Result<(), String> {
    let hands = by_thread(case, threads, 1000, |_| ())?;
    match hands.values().find(|jobs| !jobs.is_sorted()) {
        Some(jobs) => Err(format!("a worker ran the jobs {jobs:?}, which are not in order")),
        None => Ok(()),
    }
}

/// The first jobs wait for each other. Each must be from another worker's block.
fn from_blocks(case: &Case, threads: usize) -> Result<(), String> {
    if case.entry.sharing != Sharing::AtOnce {
        return Ok(());
    }
    let jobs = 40 * threads;
    let firsts = Arc::new(Mutex::new(Vec::new()));
    let (noted, meeting) = (Arc::clone(&firsts), Meeting::of_first(case, threads));
    let wait = move |index| {
        let mut firsts = noted.lock().unwrap_or_else(PoisonError::into_inner);
        if firsts.len() < threads {
            firsts.push(index);
            drop(firsts);
            meeting.wait(index);
        }
    };
    by_thread(case, threads, jobs, wait)?;
    let firsts = firsts.lock().unwrap_or_else(PoisonError::into_inner);
    let missed = (0..threads).find(|&worker| !firsts.iter().any(|first| block(worker, threads, jobs).contains(first)));
    match missed {
        Some(worker) => Err(format!("the first jobs are {firsts:?}: none is from the block of worker {worker}")),
        None => Ok(()),
    }
}
