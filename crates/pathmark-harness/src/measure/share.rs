//! One process's share of a run, whose jobs it gets a few at a time, and the run assembled from all shares.
//!
//! The assignment of jobs is decided elsewhere: between processes as between threads, it cannot change a bit of the
//! film.

use super::ledger::Ledger;
use super::observed::Observed;
use super::run::{Round, RunTotals, Timed};
use super::{JobSpan, Outcome, Setup};
use crate::error::{Error, Result};
use crate::film::{Film, Plan, Sections, TileBuffer};
use crate::kernel::{Counts, Kernel};
use crate::strategy::Strategy;
use crossbeam::atomic::AtomicCell;
use std::collections::VecDeque;
use std::mem;
use std::ops::Range;
use std::slice::from_ref;
use std::sync::Arc;
use std::time::Instant;

pub struct DoneJob {
    pub index: usize,
    /// When it ran, in seconds since the run's start, and on which of all workers.
    pub span: JobSpan,
    pub counts: Counts,
    pub tile: TileBuffer,
}

/// A process's share of a run.
pub struct Share<'a> {
    setup: &'a Setup,
    kernel: Arc<dyn Kernel>,
    plan: Arc<Plan>,
    strategy: Box<dyn Strategy>,
    start: Instant,
    /// Buffers for the jobs that the process is known to get, in their order.
    reserved: VecDeque<Box<TileBuffer>>,
    done: Vec<DoneJob>,
}

struct Handout {
    kernel: Arc<dyn Kernel>,
    plan: Arc<Plan>,
    jobs: Vec<usize>,
    tiles: Vec<AtomicCell<Option<Box<TileBuffer>>>>,
    ledger: Ledger,
}

/// The jobs of a round that several processes rendered.
pub struct MergedShare {
    pub done: Vec<DoneJob>,
    pub workers: usize,
    pub makespan_s: f64,
    /// Seconds from the end of the makespan until the jobs were in one process.
    pub gather_s: f64,
    /// The largest channel of any pixel of the jobs.
    pub brightest: f64,
}

impl Setup {
    /// Makes a share of a round that renders these sections, with its kernel and its workers, and no jobs done yet.
    pub fn share(&self, sections: &[Range<u32>]) -> Result<Share<'_>> {
        let (kernel, _) = self.kernel()?;
        let plan = Arc::new(self.ordered(self.plan_of(sections)?, &*kernel));
        let strategy = self.new_strategy()?;
        let (reserved, done) = (VecDeque::new(), Vec::new());
        Ok(Share { setup: self, kernel, plan, strategy, start: Instant::now(), reserved, done })
    }

    /// The outcome of the run that several shares make together.
    pub fn assembled(&self, gathered: MergedShare) -> Result<Outcome> {
        let (spec, samples) = (&self.settings().spec, 0..self.settings().spp);
        let mut totals = RunTotals::new();
        // The sums of a part of a pixel's samples do not tell how bright the pixel is.
        totals.brightest = Some(gathered.brightest).filter(|_| !self.decomposition.splits_samples());
        let films = totals.assemble(self, from_ref(&samples), gathered)?;
        let film = films.into_iter().next().unwrap_or_else(|| Film::new(spec.width, spec.height));
        Ok(totals.outcome(self, samples.end, film))
    }
}

impl Share<'_> {
    /// The pieces of all shares, in the order in which they are handed out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Makes buffers for the jobs that it will get, in this order, so that the run need not make them.
    pub fn reserve(&mut self, jobs: &[usize]) -> Result<()> {
        let buffer = |job: &usize| Ok(Box::new(TileBuffer::try_new(self.plan.pieces()[*job].bounds)?));
        self.reserved = jobs.iter().map(buffer).collect::<Result<_>>()?;
        Ok(())
    }

    /// Starts the run's clock, as all processes do now.
    pub fn begin(&mut self) {
        self.start = Instant::now();
    }

    pub fn elapsed_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Runs some jobs, with all workers of the strategy.
    pub fn render(&mut self, jobs: Vec<usize>) -> Result<()> {
        let mut tiles = Vec::with_capacity(jobs.len());
        for job in &jobs {
            let bounds = self.plan.pieces()[*job].bounds;
            let reserved = self.reserved.pop_front().filter(|tile| tile.bounds() == bounds);
            let tile = reserved.map_or_else(|| TileBuffer::try_new(bounds).map(Box::new), Ok)?;
            tiles.push(AtomicCell::new(Some(tile)));
        }
        let (kernel, plan) = (Arc::clone(&self.kernel), Arc::clone(&self.plan));
        let (count, ledger, start) = (jobs.len(), Ledger::new(jobs.len(), self.setup.pins()), self.start);
        let handout = Arc::new(Handout { kernel, plan, jobs, tiles, ledger });
        let shared = Arc::clone(&handout);
        let job = Arc::new(move |index: usize| {
            let Handout { kernel, plan, jobs, tiles, ledger } = &*shared;
            ledger.record(index, start, || {
                let piece = &plan.pieces()[jobs[index]];
                let mut tile = tiles[index].take().unwrap_or_else(|| Box::new(TileBuffer::new(piece.bounds)));
                let counts = kernel.render(piece, &mut tile);
                tiles[index].store(Some(tile));
                counts
            });
        });
        self.setup.keeping_affinity(|| self.strategy.run(count, job))?;
        if let Some(failure) = self.kernel.failure() {
            return Err(failure);
        }
        let broken = |problem: &str| {
            Error::Check(format!("strategy {} broke its contract: {problem}", self.setup.settings().strategy))
        };
        let Handout { jobs, tiles, mut ledger, .. } =
            Arc::into_inner(handout).ok_or_else(|| broken("it has kept the job"))?;
        ledger.check_pins()?;
        let entries = ledger.close().map_err(|problem| broken(&problem))?;
        for ((index, entry), tile) in jobs.into_iter().zip(entries).zip(tiles) {
            let tile = tile.take().ok_or_else(|| broken("it has kept a tile"))?;
            self.done.push(DoneJob { index, span: entry.span, counts: entry.counts, tile: *tile });
        }
        Ok(())
    }

    /// Seconds that its workers spent on jobs so far.
    pub fn busy_s(&self) -> f64 {
        self.done.iter().fold(0.0, |sum, job| sum + job.span.duration_s())
    }

    pub fn last(&self, count: usize) -> &[DoneJob] {
        &self.done[self.done.len().saturating_sub(count)..]
    }

    /// The largest channel of the pixels that it has rendered.
    pub fn brightest(&self) -> f64 {
        self.done.iter().fold(0.0, |largest, job| job.tile.brightest().max(largest))
    }

    pub fn take_done(&mut self) -> Vec<DoneJob> {
        mem::take(&mut self.done)
    }
}

impl RunTotals {
    /// Merges a round of several shares: returns the film of each section. Each job must have been done once.
    pub(super) fn assemble(
        &mut self,
        setup: &Setup,
        sections: &[Range<u32>],
        gathered: MergedShare,
    ) -> Result<Vec<Film>> {
        let MergedShare { mut done, workers, makespan_s, gather_s, brightest: _ } = gathered;
        let spec = &setup.settings().spec;
        let (kernel, build_s) = setup.kernel()?;
        let plan = setup.ordered(setup.plan_of(sections)?, &*kernel);
        let before_merge = Instant::now();
        done.sort_by_key(|job| job.index);
        if !done.iter().map(|job| job.index).eq(0..plan.len()) {
            let problem = format!("the processes returned {} jobs, not each of {} once", done.len(), plan.len());
            return Err(Error::Check(problem));
        }
        let mut films = Sections::new(spec.width, spec.height, sections)?;
        let (mut spans, mut counts, mut used) = (Vec::new(), Vec::new(), vec![false; workers]);
        for (piece, job) in plan.pieces().iter().zip(done) {
            films.add(&piece.samples, job.tile);
            if let Some(used) = used.get_mut(job.span.worker as usize) {
                *used = true;
            }
            spans.push(job.span);
            counts.push(job.counts);
        }
        let films = films.finish();
        let used = used.iter().filter(|used| **used).count();
        self.build_s = build_s;
        self.gather_s += gather_s;
        let round = Round {
            plan: &plan,
            sections,
            spans,
            counts,
            workers: u32::try_from(used).unwrap_or(u32::MAX),
            asked: workers.min(plan.len()),
            timed: Timed { makespan_s, cpu: None, observed: Observed::default() },
            merge_s: before_merge.elapsed().as_secs_f64(),
        };
        self.enter(setup, &*kernel, round);
        Ok(films)
    }
}
