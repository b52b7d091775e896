//! Jobs on their way to ranks.

use super::failed;
use crate::error::{Error, Result};
use crate::lab::{Master, RankRule, Way};
use crate::measure::Share;
use crate::strategy::ChunkRule;
use pathmark_mpi::{Counter, World};
use std::ops::Range;
use std::panic::resume_unwind;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// What getting jobs took.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Wait {
    pub(super) requests: u64,
    pub(super) seconds: f64,
}

/// The answer to a rank for which there is no chunk left.
const NOTHING_LEFT: u64 = u64::MAX;

/// How often rank 0 looks after the other ranks' requests while it renders. Some libraries answer them without its help, others only when it
/// calls MPI. Looking takes some microseconds.
const LOOK: Duration = Duration::from_micros(200);

/// The chunks of a rule in the order of their numbers, for so many ranks that render.
fn chunks_of(rule: ChunkRule, jobs: usize, ranks: usize) -> Vec<Range<usize>> {
    rule.chunks(jobs, ranks.max(1)).collect()
}

/// What the ranks need to share jobs by a rule: made before the clock starts.
pub(super) struct HandOut<'a> {
    world: &'a World,
    way: Way,
    counter: Option<Counter<'a>>,
}

impl<'a> HandOut<'a> {
    pub(super) fn new(rule: &RankRule, world: &'a World, share: &mut Share<'_>) -> Result<Self> {
        if let Way::Dealt(deal) = rule.way() {
            let jobs: Vec<usize> = deal(world.rank(), world.size(), share.plan().len()).collect();
            share.reserve(&jobs)?;
        }
        let counter =
            if matches!(rule.way(), Way::Counted(_)) { Some(Counter::new(world).map_err(failed)?) } else { None };
        Ok(Self { world, way: rule.way(), counter })
    }

    /// Does this rank's jobs until none are left for it.
    pub(super) fn run(&self, share: &mut Share<'_>) -> Result<Wait> {
        let (world, jobs) = (self.world, share.plan().len());
        match self.way {
            Way::Dealt(deal) => {
                share.render(deal(world.rank(), world.size(), jobs).collect())?;
                Ok(Wait::default())
            }
            Way::Counted(rule) => {
                let chunks = chunks_of(rule, jobs, world.size());
                self.counter.as_ref().map_or(Ok(Wait::default()), |counter| counted(counter, &chunks, world, share))
            }
            Way::Asked(master, rule) => {
                let ranks = if master == Master::Only { world.size() - 1 } else { world.size() };
                let chunks = chunks_of(rule, jobs, ranks);
                match (world.rank(), master) {
                    (0, Master::Only) => answer_all(chunks.len(), world),
                    (0, Master::Working) => work_and_answer(&chunks, world, share),
                    _ => ask(&chunks, world, share),
                }
            }
        }
    }

    /// Frees what was made, when all ranks are here.
    pub(super) fn free(self) -> Result<()> {
        self.counter.map_or(Ok(()), |counter| counter.free().map_err(failed))
    }
}

/// Waits for something, and adds how long that took.
fn timed<T>(wait: &mut Wait, share: &Share<'_>, get: impl FnOnce() -> Result<T>) -> Result<T> {
    let before_s = share.elapsed_s();
    let got = get()?;
    wait.seconds += share.elapsed_s() - before_s;
    wait.requests += 1;
    Ok(got)
}

fn counted(counter: &Counter<'_>, chunks: &[Range<usize>], world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let mut wait = Wait::default();
    loop {
        let step = timed(&mut wait, share, || counter.next().map_err(failed))?;
        let Some(chunk) = usize::try_from(step).ok().and_then(|step| chunks.get(step)) else { return Ok(wait) };
        let jobs = chunk.clone().collect();
        if world.rank() == 0 && world.size() > 1 {
            render_attentively(jobs, world, share)?;
        } else {
            share.render(jobs)?;
        }
    }
}

/// Renders on another thread, while this one, which alone may call MPI, looks after the other ranks.
fn render_attentively(jobs: Vec<usize>, world: &World, share: &mut Share<'_>) -> Result<()> {
    thread::scope(|scope| {
        let (tell, told) = channel();
        let render = move || {
            let done = share.render(jobs);
            // Nobody listens any more if MPI has failed.
            tell.send(()).unwrap_or_default();
            done
        };
        let rendering = thread::Builder::new()
            .spawn_scoped(scope, render)
            .map_err(|e| Error::system("starting", "the thread that renders", e))?;
        while told.recv_timeout(LOOK).is_err() && !rendering.is_finished() {
            world.has_message().map_err(failed)?;
        }
        rendering.join().unwrap_or_else(|panic| resume_unwind(panic))
    })
}

/// Asks rank 0 for chunks.
fn ask(chunks: &[Range<usize>], world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let mut wait = Wait::default();
    loop {
        let step = timed(&mut wait, share, || {
            world.send(0, &[world.rank() as u64]).map_err(failed)?;
            let mut answer = [0];
            world.receive(Some(0), &mut answer).map_err(failed)?;
            Ok(answer[0])
        })?;
        let Some(chunk) = usize::try_from(step).ok().and_then(|step| chunks.get(step)) else { return Ok(wait) };
        share.render(chunk.clone().collect())?;
    }
}

/// The other side of [`ask`].
struct Desk<'a> {
    world: &'a World,
    chunks: usize,
    next: usize,
    /// Ranks that have not been told that nothing is left.
    asking: usize,
}

impl<'a> Desk<'a> {
    fn new(chunks: usize, world: &'a World) -> Self {
        Self { world, chunks, next: 0, asking: world.size() - 1 }
    }

    /// The number of the next chunk, if one is left.
    fn take(&mut self) -> Option<usize> {
        let step = self.next;
        self.next += 1;
        (step < self.chunks).then_some(step)
    }

    /// Waits for a request, and answers it.
    fn answer(&mut self) -> Result<()> {
        let mut from = [0];
        self.world.receive(None, &mut from).map_err(failed)?;
        let step = self.take();
        if step.is_none() {
            self.asking -= 1;
        }
        let step = step.map_or(NOTHING_LEFT, |step| step as u64);
        self.world.send(usize::try_from(from[0]).unwrap_or(0), &[step]).map_err(failed)
    }
}

fn answer_all(chunks: usize, world: &World) -> Result<Wait> {
    let mut desk = Desk::new(chunks, world);
    while desk.asking > 0 {
        desk.answer()?;
    }
    Ok(Wait::default())
}

fn work_and_answer(chunks: &[Range<usize>], world: &World, share: &mut Share<'_>) -> Result<Wait> {
    let mut desk = Desk::new(chunks.len(), world);
    loop {
        while desk.asking > 0 && world.has_message().map_err(failed)? {
            desk.answer()?;
        }
        let Some(step) = desk.take() else { break };
        share.render(chunks[step].clone().collect())?;
    }
    let before_s = share.elapsed_s();
    while desk.asking > 0 {
        desk.answer()?;
    }
    Ok(Wait { requests: 0, seconds: share.elapsed_s() - before_s })
}
