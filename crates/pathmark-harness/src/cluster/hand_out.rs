//! Distribution of jobs to ranks.

use super::failed;
use crate::error::{Error, Result};
use crate::lab::{Distribution, LOOK, Master, RankRule, is_small};
use crate::measure::Share;
use crate::strategy::{LearnedRule, Ledger, Seen};
use pathmark_mpi::{Counter, World};
use std::cell::RefCell;
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Instant;
use std::vec::IntoIter;

#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wait {
    pub(super) requests: u64,
    pub(super) seconds: f64,
}

/// The answer to a rank if no chunk is left.
const NOTHING_LEFT: [u64; 2] = [0; 2];

/// The resources with which ranks share jobs by a rule; made before the clock starts.
pub(super) struct HandOut<'a> {
    world: &'a World,
    distribution: Distribution,
    counter: Option<Counter<'a>>,
}

impl<'a> HandOut<'a> {
    pub(super) fn new(rule: &RankRule, world: &'a World, share: &mut Share<'_>) -> Result<Self> {
        if let Distribution::Static(deal) = rule.distribution() {
            let jobs: Vec<usize> = deal(world.rank(), world.size(), share.plan().len()).collect();
            share.reserve(&jobs)?;
        }
        let counter = if matches!(rule.distribution(), Distribution::SharedCounter(_)) {
            Some(Counter::new(world).map_err(failed)?)
        } else {
            None
        };
        Ok(Self { world, distribution: rule.distribution(), counter })
    }

    pub(super) fn run(&mut self, share: &mut Share<'_>) -> Result<Wait> {
        let (world, jobs) = (self.world, share.plan().len());
        match self.distribution {
            Distribution::Static(deal) => {
                share.render(deal(world.rank(), world.size(), jobs).collect())?;
                Ok(Wait::default())
            }
            Distribution::SharedCounter(rule) => {
                let chunks: Vec<_> = rule.chunks(jobs, world.size()).collect();
                self.counter.as_mut().map_or(Ok(Wait::default()), |counter| counted(counter, &chunks, world, share))
            }
            Distribution::Master(master, rule) => {
                let ranks = if master == Master::Only { world.size() - 1 } else { world.size() };
                let stock = || Stock::Chunks(rule.chunks(jobs, ranks.max(1)).collect::<Vec<_>>().into_iter());
                match (world.rank(), master) {
                    (0, Master::Only) => Desk::new(stock(), world).answer_the_last().map(|_| Wait::default()),
                    (0, Master::Working) => answer_between_chunks(stock(), world, share),
                    _ => ask(world, share),
                }
            }
            Distribution::Adaptive(rule) if world.rank() == 0 => {
                let ledger = Box::new(Ledger::new(jobs, world.size(), rule.weights));
                answer_at_once(Stock::Learned(rule, ledger), world, share)
            }
            Distribution::Adaptive(_) => ask(world, share),
        }
    }

    /// Frees the counter, once all ranks have arrived.
    pub(super) fn free(self) -> Result<()> {
        self.counter.map_or(Ok(()), |counter| counter.free().map_err(failed))
    }
}

/// Calls `get`, and adds its seconds and one request to `wait`.
fn timed<T>(wait: &mut Wait, get: impl FnOnce() -> Result<T>) -> Result<T> {
    let begin = Instant::now();
    let got = get()?;
    wait.seconds += begin.elapsed().as_secs_f64();
    wait.requests += 1;
    Ok(got)
}

/// Renders chunks by counter. While a rank renders a small chunk, its request for the next one is already under way.
fn counted(counter: &mut Counter<'_>, chunks: &[Range<usize>], world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let mut wait = Wait::default();
    let jobs = share.plan().len();
    let next = |counter: &mut Counter<'_>| {
        let step = counter.number().map_err(failed)?;
        Ok(usize::try_from(step).ok().and_then(|step| chunks.get(step)).cloned())
    };
    if world.rank() == 0 && world.size() > 1 {
        let look = || world.has_message().map(drop).map_err(failed);
        render_attentively(share, |_| timed(&mut wait, || next(counter)), look)?;
        return Ok(wait);
    }
    while let Some(chunk) = timed(&mut wait, || next(counter))? {
        if is_small(chunk.len(), jobs, world.size()) {
            counter.ask().map_err(failed)?;
        }
        share.render(chunk.collect())?;
    }
    Ok(wait)
}

/// Renders chunk after chunk on another thread. This thread, the only one that may call MPI, gets the chunks and looks
/// after the other ranks.
fn render_attentively(
    share: &mut Share<'_>,
    mut next: impl FnMut(Seen) -> Result<Option<Range<usize>>>,
    mut look: impl FnMut() -> Result<()>,
) -> Result<()> {
    thread::scope(|scope| {
        let (ask, asked) = channel();
        let (give, given) = channel();
        let render = move || {
            let mut seen = Seen::default();
            // After an error of MPI no answer comes.
            while ask.send(seen).is_ok()
                && let Ok(chunk) = given.recv()
            {
                seen = seen_rendering(chunk, share)?;
            }
            Ok(())
        };
        let rendering = thread::Builder::new()
            .spawn_scoped(scope, render)
            .map_err(|e| Error::system("starting", "the thread that renders", e))?;
        loop {
            let request = asked.recv_timeout(LOOK);
            look()?;
            match request {
                // The rendering thread is there: it waits for the answer.
                Ok(seen) => match next(seen)? {
                    Some(chunk) => give.send(chunk).unwrap_or_default(),
                    None => break,
                },
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        drop(give);
        rendering.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Asks rank 0 for chunks, and reports how long the last one took.
fn ask(world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let (mut wait, mut seen) = (Wait::default(), Seen::default());
    loop {
        let request = [world.rank() as u64, seen.jobs as u64, seen.seconds.to_bits(), seen.squares.to_bits()];
        let answer = timed(&mut wait, || {
            world.send(0, &request).map_err(failed)?;
            let mut answer = NOTHING_LEFT;
            world.receive(Some(0), &mut answer).map_err(failed)?;
            Ok(answer)
        })?;
        let [start, end] = answer.map(|word| usize::try_from(word).unwrap_or(usize::MAX));
        if start >= end.min(share.plan().len()) {
            return Ok(wait);
        }
        seen = seen_rendering(start..end.min(share.plan().len()), share)?;
    }
}

/// Renders, and returns the job durations. Jobs of several threads count as if they had run one after the other in the
/// elapsed time.
fn seen_rendering(jobs: Range<usize>, share: &mut Share<'_>) -> Result<Seen> {
    let (before_s, count) = (share.elapsed_s(), jobs.len());
    share.render(jobs.collect())?;
    let seconds = share.elapsed_s() - before_s;
    let durations = || share.last(count).iter().map(|job| job.span.duration_s());
    let busy_s: f64 = durations().sum();
    if busy_s <= 0.0 {
        return Ok(Seen::default());
    }
    Ok(durations().map(|duration| duration * seconds / busy_s).collect())
}

enum Stock {
    Chunks(IntoIter<Range<usize>>),
    /// Chunks whose sizes depend on how fast the ranks have been.
    Learned(LearnedRule, Box<Ledger>),
}

struct Desk<'a> {
    world: &'a World,
    stock: Stock,
    /// Ranks that have not yet been told that nothing is left.
    asking: usize,
}

impl<'a> Desk<'a> {
    fn new(stock: Stock, world: &'a World) -> Self {
        Self { world, stock, asking: world.size() - 1 }
    }

    fn take(&mut self, rank: usize, seen: Seen) -> Option<Range<usize>> {
        match &mut self.stock {
            Stock::Chunks(chunks) => chunks.next(),
            Stock::Learned(rule, ledger) => {
                ledger.note(rank, seen);
                rule.next(ledger, rank)
            }
        }
    }

    fn answer_who_waits(&mut self) -> Result<()> {
        while self.asking > 0 && self.world.has_message().map_err(failed)? {
            self.answer()?;
        }
        Ok(())
    }

    /// Answers the remaining requests, until every rank has been told that nothing is left.
    fn answer_the_last(&mut self) -> Result<Wait> {
        let mut wait = Wait::default();
        while self.asking > 0 {
            timed(&mut wait, || self.answer())?;
        }
        Ok(Wait { requests: 0, ..wait })
    }

    fn answer(&mut self) -> Result<()> {
        let mut request = [0; 4];
        self.world.receive(None, &mut request).map_err(failed)?;
        let [rank, jobs, seconds, squares] = request;
        let rank = usize::try_from(rank).ok().filter(|rank| *rank < self.world.size()).unwrap_or(0);
        let jobs = usize::try_from(jobs).unwrap_or(0);
        let seen = Seen { jobs, seconds: f64::from_bits(seconds), squares: f64::from_bits(squares) };
        let answer = if let Some(chunk) = self.take(rank, seen) {
            [chunk.start as u64, chunk.end as u64]
        } else {
            self.asking -= 1;
            NOTHING_LEFT
        };
        self.world.send(rank, &answer).map_err(failed)
    }
}

/// Answers between rank 0's own chunks, as a program with a single thread does.
fn answer_between_chunks(stock: Stock, world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let (mut desk, mut seen) = (Desk::new(stock, world), Seen::default());
    loop {
        desk.answer_who_waits()?;
        let Some(chunk) = desk.take(0, seen) else { break };
        seen = seen_rendering(chunk, share)?;
    }
    desk.answer_the_last()
}

/// Answers at any time: the first chunks of learned rules are large, and a rank that asks should not wait for one.
fn answer_at_once(stock: Stock, world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let desk = RefCell::new(Desk::new(stock, world));
    let next = |seen| Ok(desk.borrow_mut().take(0, seen));
    render_attentively(share, next, || desk.borrow_mut().answer_who_waits())?;
    desk.into_inner().answer_the_last()
}
