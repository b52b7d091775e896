//! The table of a simulation: every contender on every number of workers, beside a lower bound for every schedule and an
//! upper one for greedy schedules.
//!
//! Graham, "Bounds for certain multiprocessing anomalies", Bell System Technical Journal 45(9), 1966: a schedule that never leaves a
//! worker idle while a job waits ends at W/P + (1 - 1/P) L at the latest, for work W, longest job L and P equal workers; since no
//! schedule ends before W/P or before L, that is at most 2 - 1/P times the best. Graham, "Bounds on multiprocessing timing anomalies",
//! SIAM Journal on Applied Mathematics 17(2), 1969: with the longest jobs first, it is at most 4/3 - 1/(3P) times the best.

use super::contender::Contender;
use super::hardware::Hardware;
use crate::analysis::crossed::{Crossed, geometric_mean};
use crate::analysis::quantile::median;
use crate::strategy::Discipline;

#[derive(Debug, Clone, PartialEq)]
pub struct Forecast {
    pub strategy: String,
    /// Workers; processors, for a thread per job.
    pub workers: usize,
    /// Replays behind the values: serial runs, and calibrations.
    pub traces: usize,
    pub calibrations: usize,
    pub makespan_s: Crossed,
    /// The sum of all costs over the makespan: the reference is the jobs in sequence, without overhead.
    pub speedup: Crossed,
    /// Work per worker, in seconds: no schedule ends earlier if no processor is faster than 1.
    pub share_s: f64,
    /// The longest job, in seconds: no schedule ends earlier.
    pub longest_s: f64,
    /// Graham's bound in seconds: every greedy schedule ends by then, on equal workers and without overheads.
    pub greedy_s: f64,
}

impl Forecast {
    /// The speedup for each worker.
    pub fn efficiency(&self) -> Option<Crossed> {
        self.speedup.through(|speedup| Some(speedup / self.workers.max(1) as f64))
    }
}

/// Replays the jobs of each trace (costs in seconds, in index order) with the costs of each calibration, by every
/// contender on every number of workers. A value is the geometric mean over all of these replays. Its interval of this
/// `level` contains the differences between the traces and those between the calibrations.
///
/// A contender that runs the jobs in order on the caller's thread has one worker, whatever `workers` says, and one row.
/// Without jobs there is no row.
pub fn forecast(
    traces: &[Vec<f64>],
    contenders: &[Contender],
    workers: &[usize],
    hardware: &Hardware,
    level: f64,
) -> Vec<Forecast> {
    let typical = typical_costs(traces);
    let mut rows = Vec::new();
    for contender in contenders {
        let workers = if let Discipline::InOrder = contender.discipline { &[1] } else { workers };
        let by_calibration = contender.by_calibration();
        rows.extend(workers.iter().filter_map(|&workers| {
            let replays: Vec<Vec<f64>> = traces
                .iter()
                .map(|costs| by_calibration.iter().map(|one| one.replay(costs, workers, hardware).makespan_s).collect())
                .collect();
            let works = traces.iter().map(|costs| costs.iter().sum::<f64>());
            let speedups: Vec<Vec<f64>> = works
                .zip(&replays)
                .map(|(work_s, row)| row.iter().map(|makespan_s| work_s / makespan_s).collect())
                .collect();
            let bounds = bounds(&typical, workers);
            Some(Forecast {
                strategy: contender.name.clone(),
                workers,
                traces: traces.len(),
                calibrations: by_calibration.len(),
                makespan_s: geometric_mean(&replays, level)?,
                speedup: geometric_mean(&speedups, level)?,
                share_s: bounds.share_s,
                longest_s: bounds.longest_s,
                greedy_s: bounds.greedy_s,
            })
        }));
    }
    rows
}

/// The cost of each job: its median over the traces that have as many jobs as the first. A disturbance of one run
/// therefore makes no job the longest.
pub fn typical_costs(traces: &[Vec<f64>]) -> Vec<f64> {
    let Some(first) = traces.first() else { return Vec::new() };
    let alike = || traces.iter().filter(|costs| costs.len() == first.len());
    (0..first.len()).filter_map(|job| median(&alike().map(|costs| costs[job]).collect::<Vec<f64>>())).collect()
}

/// The bounds for jobs without overheads on equal workers of speed 1, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    pub share_s: f64,
    pub longest_s: f64,
    /// The larger of the two: no schedule ends earlier.
    pub lower_s: f64,
    /// W/P + (1 - 1/P) L: every greedy schedule ends by then.
    pub greedy_s: f64,
}

/// The bounds for jobs of these costs, in seconds, on `workers` workers (at least 1).
pub fn bounds(costs: &[f64], workers: usize) -> Bounds {
    let workers = workers.max(1) as f64;
    let share_s = costs.iter().sum::<f64>() / workers;
    let longest_s = costs.iter().copied().fold(0.0, f64::max);
    let lower_s = share_s.max(longest_s);
    Bounds { share_s, longest_s, lower_s, greedy_s: share_s + (1.0 - 1.0 / workers) * longest_s }
}

/// Returns the order in which the longest of these jobs goes first; equal ones keep their order.
pub fn longest_first(costs: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
    order
}

#[cfg(test)]
mod tests {
    use super::super::{Order, Overheads};
    use super::*;

    fn serial() -> Contender {
        Contender {
            name: "in order".to_owned(),
            discipline: Discipline::InOrder,
            order: Order::ByIndex,
            overheads: Overheads::default(),
            calibrations: Vec::new(),
        }
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12 * b.abs()
    }

    #[test]
    fn rows_by_hand() {
        let contenders = [serial(), Contender::longest_first()];
        let traces = [vec![1.0, 1.0, 2.0]];
        let rows = forecast(&traces, &contenders, &[2, 4], &Hardware::default(), 0.95);
        let expected = [(1, 4.0, 1.0, 1.0, 4.0), (2, 2.0, 2.0, 1.0, 2.0), (4, 2.0, 2.0, 0.5, 1.0)];
        assert_eq!(rows.len(), expected.len());
        for (row, (workers, makespan_s, speedup, efficiency, share_s)) in rows.iter().zip(expected) {
            assert_eq!((row.workers, row.longest_s, row.share_s), (workers, 2.0, share_s));
            assert!(close(row.makespan_s.value, makespan_s) && close(row.speedup.value, speedup), "{row:?}");
            assert!(close(row.efficiency().unwrap().value, efficiency) && row.speedup.interval.is_none(), "{row:?}");
        }
        assert!(forecast(&[], &contenders, &[2], &Hardware::default(), 0.95).is_empty());
        assert!(forecast(&[vec![]], &contenders, &[2], &Hardware::default(), 0.95).is_empty());
    }

    /// Four jobs of a second on four workers, by blocks. The last worker starts after four starts, so the makespan is 1 s
    /// plus 4 starts. Only the calibrations differ, and their interval is Student's.
    #[test]
    fn calibrations_make_an_interval() {
        use crate::lab::Lab;
        use crate::measure::CalibrationRow;
        use crate::simulate::contenders;
        let starts = [0.01, 0.02, 0.05];
        let rows = starts.iter().enumerate().flat_map(|(calibration, start_s)| {
            [1, 2, 4].map(|threads| CalibrationRow {
                calibration: calibration as u32,
                ..CalibrationRow::of_starts("static-blocks", threads, *start_s)
            })
        });
        let known = contenders(&Lab::new(), &rows.collect::<Vec<_>>());
        let found = forecast(&[vec![1.0; 4]], &known, &[4], &Hardware::default(), 0.95);
        let speedups = starts.map(|start_s| 4.0 / (1.0 + 4.0 * start_s));
        let expected = crate::analysis::mean::geometric_interval(&speedups, 0.95).unwrap();
        let interval = found[0].speedup.interval.unwrap();
        assert_eq!((found[0].traces, found[0].calibrations), (1, 3));
        assert!((found[0].speedup.value - expected.value).abs() < 1e-6, "{found:?} {expected:?}");
        assert!((interval.low - expected.interval.low).abs() < 1e-6, "{found:?} {expected:?}");
        // One calibration of three traces: the traces differ in their longest job.
        let traces = [1.0, 2.0, 4.0].map(|longest| vec![1.0, 1.0, longest]);
        let found = forecast(&traces, &[Contender::longest_first()], &[2], &Hardware::default(), 0.95);
        let speedups = [3.0 / 2.0, 4.0 / 2.0, 6.0 / 4.0];
        let expected = crate::analysis::mean::geometric_interval(&speedups, 0.95).unwrap();
        assert!((found[0].speedup.interval.unwrap().high - expected.interval.high).abs() < 1e-9);
        // Medians: 1, 1, 2.
        assert_eq!((found[0].longest_s, found[0].share_s), (2.0, 2.0));
    }

    #[test]
    fn bounds_by_hand() {
        let of = bounds(&[1.0, 1.0, 6.0, 2.0], 4);
        assert_eq!(of, Bounds { share_s: 2.5, longest_s: 6.0, lower_s: 6.0, greedy_s: 2.5 + 0.75 * 6.0 });
        assert_eq!(bounds(&[1.0; 8], 4).lower_s, 2.0);
        assert_eq!(bounds(&[], 3).greedy_s, 0.0);
    }

    #[test]
    fn longest_goes_first() {
        assert_eq!(longest_first(&[1.0, 3.0, 2.0, 3.0]), [1, 3, 2, 0]);
    }
}
