//! Overheads of a strategy's mechanism, fitted to runs of empty jobs.
//!
//! The model of n empty jobs on p workers is a line in n for each p,
//!
//! T(n, p) = run + p start + n max((job + take) / p, shared),
//!
//! whose five parameters are in seconds. The lines are fitted to measured rows ([`CalibrationRow`]). The lines'
//! intercepts over p give `run` and `start`. The slope at one worker gives the cost of a hand-out. The slopes at more
//! workers give the rate of the shared place: the counter or queue from which all workers take. All fits are ordinary
//! least squares; values that noise makes negative are set to 0.

use crate::measure::CalibrationRow;
use crate::strategy::{Discipline, Start};

/// The mechanism's costs with one number of workers. The default costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Overhead {
    /// Seconds that a run takes without workers and jobs.
    pub run_s: f64,
    /// The caller's seconds to start (or wake) one more worker, or thread; one after the other.
    pub start_s: f64,
    /// A worker's seconds for each job: the call, and taking the job from the worker's own queue or range.
    pub job_s: f64,
    /// A worker's seconds for each chunk that it takes from the shared place.
    pub take_s: f64,
    /// Seconds for which each chunk (each job of a batch) occupies the shared place, whichever worker takes it.
    pub shared_s: f64,
}

/// The costs of one strategy's mechanism, over numbers of workers. The default costs nothing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Overheads {
    run_s: f64,
    pub(super) start_s: f64,
    job_s: f64,
    /// The cost of a chunk; `None` if the rows have too few chunks to fit it, and chunks are then free.
    pub(super) place: Option<Place>,
}

/// The shared place: all workers take from it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Place {
    pub(super) take_s: f64,
    /// Seconds between two hand-outs if this many workers, at least 2, ask without a pause; ascending.
    served: Vec<(usize, f64)>,
}

impl Overheads {
    /// Fits the costs to rows of empty jobs run by one strategy, at one number of jobs or (better) several for each
    /// number of threads.
    ///
    /// * Under [`Discipline::AllAtOnce`] the caller pays for each job: the slope is `start`. The slope of the CPU time
    ///   minus that slope is the thread's own start and end, on another processor: `job`.
    /// * The shared place is a chunk rule that hands out single jobs, or a queue in which all jobs start. The slope at
    ///   p threads is used as its rate, although the place could be faster than p workers.
    /// * A rule with larger chunks, or with chunks that depend on the clock, has too few chunks to separate their cost
    ///   from the jobs'.
    pub fn fit<'a>(rows: impl IntoIterator<Item = &'a CalibrationRow>, discipline: Discipline) -> Self {
        let rows: Vec<&CalibrationRow> = rows.into_iter().collect();
        let mut threads: Vec<usize> = rows.iter().map(|row| row.threads).collect();
        threads.sort_unstable();
        threads.dedup();
        let line_at = |threads: usize, seconds: fn(&CalibrationRow) -> Option<f64>| {
            let of = rows.iter().filter(|row| row.threads == threads);
            Line::rising(&of.filter_map(|row| Some((row.jobs as f64, seconds(row)?))).collect::<Vec<_>>())
        };
        let wall = |row: &CalibrationRow| Some(row.seconds);
        let lines: Vec<(usize, Line)> = threads.into_iter().map(|threads| (threads, line_at(threads, wall))).collect();
        let Some(&(fewest, first)) = lines.first() else { return Self::default() };
        if let Discipline::AllAtOnce = discipline {
            let cpu = line_at(fewest, |row| row.cpu_s);
            let job_s = (cpu.slope - first.slope).max(0.0);
            return Self { run_s: first.at_zero, start_s: first.slope, job_s, place: Some(Place::default()) };
        }
        let over_threads =
            Line::rising(&lines.iter().map(|(threads, line)| (*threads as f64, line.at_zero)).collect::<Vec<_>>());
        let served = || lines.iter().filter(|(threads, _)| *threads > 1).map(|(threads, line)| (*threads, line.slope));
        let (job_s, place) = match discipline {
            Discipline::Chunks(rule) => {
                let single = rows.iter().all(|row| rule.chunks(row.jobs, row.threads).count() == row.jobs);
                let place = || Place { take_s: first.slope, served: served().collect() };
                if single { (0.0, Some(place())) } else { (first.slope, None) }
            }
            Discipline::Learned(_) => (first.slope, None),
            Discipline::Stealing(stealing) if matches!(stealing.start, Start::Shared(_)) => {
                (first.slope, Some(Place { take_s: 0.0, served: served().collect() }))
            }
            _ => (first.slope, Some(Place::default())),
        };
        Self { run_s: over_threads.at_zero, start_s: over_threads.slope, job_s, place }
    }

    /// Returns the costs with `workers` workers. The rate of the shared place is that of the largest measured number of
    /// workers up to `workers`. Beyond the machine's processors that is an extrapolation, and an optimistic one, since
    /// contention grows.
    pub fn at(&self, workers: usize) -> Overhead {
        let place = self.place.clone().unwrap_or_default();
        let shared_s = place.served.iter().take_while(|(threads, _)| *threads <= workers).last().map_or(0.0, |s| s.1);
        let Self { run_s, start_s, job_s, .. } = *self;
        Overhead { run_s, start_s, job_s, take_s: place.take_s, shared_s }
    }
}

/// A line that does not fall and is not negative at 0.
#[derive(Debug, Clone, Copy, Default)]
struct Line {
    at_zero: f64,
    slope: f64,
}

impl Line {
    /// The best line under both conditions; a horizontal one if all points have the same x.
    fn rising(points: &[(f64, f64)]) -> Self {
        let n = points.len() as f64;
        if points.is_empty() {
            return Self::default();
        }
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let (covariance, variance) = (mean(&|p| (p.0 - x) * (p.1 - y)), mean(&|p| (p.0 - x) * (p.0 - x)));
        let slope = if variance > 0.0 { (covariance / variance).max(0.0) } else { 0.0 };
        let at_zero = y - slope * x;
        if at_zero >= 0.0 {
            return Self { at_zero, slope };
        }
        Self { at_zero: 0.0, slope: mean(&|p| p.0 * p.1) / mean(&|p| p.0 * p.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{Hardware, replay};
    use crate::strategy::{Amount, ChunkRule, Stealing, Victim};

    const RUN: f64 = 3e-6;
    const START: f64 = 2e-5;
    const JOB: f64 = 4e-9;
    /// Seconds between two hand-outs of a contended place.
    const SERVED: f64 = 3e-8;

    fn rows(threads: &[usize], seconds: impl Fn(f64, f64) -> f64) -> Vec<CalibrationRow> {
        let at = |&threads: &usize| {
            let seconds = |jobs: usize| seconds(jobs as f64, threads as f64);
            [200, 4000].map(|jobs| CalibrationRow {
                strategy: String::new(),
                threads,
                jobs,
                seconds: seconds(jobs),
                cpu_s: None,
                started: 0,
                calibration: 0,
            })
        };
        threads.iter().flat_map(at).collect()
    }

    fn single() -> Discipline {
        Discipline::Chunks(ChunkRule { size: |_| 1, parameter: 1 })
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-9 * b.abs() + 1e-15
    }

    #[test]
    fn the_parameters_of_a_shared_place_come_back() {
        let rows =
            rows(&[1, 2, 4], |n, p| RUN + p * START + n * if p > 1.0 { SERVED * f64::midpoint(p, 2.0) } else { JOB });
        let fitted = Overheads::fit(&rows, single());
        assert!(fitted.place.is_some());
        for (workers, shared_s) in
            [(1, 0.0), (2, 2.0 * SERVED), (3, 2.0 * SERVED), (4, 3.0 * SERVED), (4096, 3.0 * SERVED)]
        {
            let at = fitted.at(workers);
            assert!(close(at.run_s, RUN) && close(at.start_s, START) && close(at.take_s, JOB), "{at:?}");
            assert!(at.job_s == 0.0 && close(at.shared_s, shared_s), "{workers}: {at:?}");
        }
    }

    #[test]
    fn the_parameters_of_own_queues_come_back() {
        let rows = rows(&[1, 2], |n, p| RUN + p * START + n * JOB / p);
        let stealing = Stealing { start: Start::Blocks, amount: Amount::Half, victim: Victim::Random };
        for discipline in [Discipline::Halving, Discipline::Stealing(stealing)] {
            let at = Overheads::fit(&rows, discipline).at(2);
            assert!(close(at.run_s, RUN) && close(at.start_s, START) && close(at.job_s, JOB), "{at:?}");
            assert_eq!((at.take_s, at.shared_s), (0.0, 0.0));
        }
    }

    #[test]
    fn a_thread_for_each_job_costs_the_caller_a_start() {
        let mut rows = rows(&[1], |n, _| RUN + n * START);
        let at = Overheads::fit(&rows, Discipline::AllAtOnce).at(64);
        assert!(close(at.run_s, RUN) && close(at.start_s, START) && at.job_s == 0.0, "{at:?}");
        // The threads themselves use half as much again.
        for row in &mut rows {
            row.cpu_s = Some(1e-3 + row.jobs as f64 * 1.5 * START);
        }
        let at = Overheads::fit(&rows, Discipline::AllAtOnce).at(64);
        assert!(close(at.start_s, START) && close(at.job_s, 0.5 * START), "{at:?}");
    }

    #[test]
    fn large_chunks_are_paid_for_elsewhere() {
        let halves = Discipline::Chunks(ChunkRule { size: |h| (h.jobs - h.start).div_ceil(2), parameter: 1 });
        let coarse = Overheads::fit(&rows(&[1, 2], |n, p| RUN + p * START + n * JOB / p), halves);
        assert!(coarse.place.is_none() && close(coarse.at(2).job_s, JOB) && coarse.at(2).shared_s == 0.0);
        let fine = Overheads::fit(&rows(&[1, 2], |n, p| RUN + p * START + n * SERVED), single());
        let lent = Overheads { place: fine.place.clone(), ..coarse }.at(2);
        assert!(close(lent.job_s, JOB) && close(lent.take_s, SERVED) && close(lent.shared_s, SERVED), "{lent:?}");
    }

    /// Fitting and replaying are each other's inverse.
    #[test]
    fn the_replay_of_empty_jobs_gives_the_rows_back() {
        let rows = rows(&[1, 2], |n, p| RUN + p * START + n * if p > 1.0 { SERVED } else { JOB });
        let fitted = Overheads::fit(&rows, single());
        for row in &rows {
            let costs = vec![0.0; row.jobs];
            let replayed = replay(&costs, single(), row.threads, &fitted.at(row.threads), &Hardware::default());
            // The first worker begins before the last one has been started.
            let error = (replayed.makespan_s - row.seconds).abs();
            assert!(error <= START + SERVED, "{row:?}: {}", replayed.makespan_s);
        }
    }

    #[test]
    fn noise_makes_nothing_negative() {
        let falling = rows(&[1, 2], |n, p| 1e-4 - 1e-9 * n - 1e-6 * p);
        let at = Overheads::fit(&falling, single()).at(2);
        assert!(at.run_s > 0.0 && at.start_s == 0.0 && at.take_s == 0.0 && at.shared_s == 0.0, "{at:?}");
        let steep = Line::rising(&[(1.0, 1.0), (2.0, 4.0)]);
        assert!(steep.at_zero == 0.0 && close(steep.slope, 1.8), "{steep:?}");
        assert_eq!(Overheads::fit(&[], single()), Overheads::default());
    }
}
