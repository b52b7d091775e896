//! The table of a simulation: every contender on every number of workers, beside a lower bound for every schedule and an
//! upper one for greedy schedules.
//!
//! Graham, "Bounds for certain multiprocessing anomalies", Bell System Technical Journal 45(9), 1966: a schedule that never leaves a
//! worker idle while a job waits ends at W/P + (1 - 1/P) L at the latest, for work W, longest job L and P equal workers; since no
//! schedule ends before W/P or before L, that is at most 2 - 1/P times the best. Graham, "Bounds on multiprocessing timing anomalies",
//! SIAM Journal on Applied Mathematics 17(2), 1969: with the longest jobs first, it is at most 4/3 - 1/(3P) times the best.

use super::contender::Contender;
use super::hardware::Hardware;
use crate::strategy::Discipline;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Forecast {
    pub strategy: String,
    /// Workers; processors, for a thread per job.
    pub workers: usize,
    pub makespan_s: f64,
    /// The sum of all costs over the makespan: the reference is the jobs in sequence, without overhead.
    pub speedup: f64,
    pub efficiency: f64,
    /// Work per worker, in seconds: no schedule ends earlier if no processor is faster than 1.
    pub share_s: f64,
    /// The longest job, in seconds: no schedule ends earlier.
    pub longest_s: f64,
    /// Graham's bound in seconds: every greedy schedule ends by then, on equal workers and without overheads.
    pub greedy_s: f64,
}

/// Replays jobs of these costs (seconds, in index order) by every contender on every number of workers. A contender
/// that runs the jobs in order on the caller's thread has one worker, whatever `workers` says, and one row.
pub fn forecast(costs: &[f64], contenders: &[Contender], workers: &[usize], hardware: &Hardware) -> Vec<Forecast> {
    let mut rows = Vec::new();
    for contender in contenders {
        let workers = if let Discipline::InOrder = contender.discipline { &[1] } else { workers };
        rows.extend(workers.iter().map(|&workers| row(costs, contender, workers, hardware)));
    }
    rows
}

fn row(costs: &[f64], contender: &Contender, workers: usize, hardware: &Hardware) -> Forecast {
    let makespan_s = contender.replay(costs, workers, hardware).makespan_s;
    let speedup = if makespan_s > 0.0 { costs.iter().sum::<f64>() / makespan_s } else { 1.0 };
    let bounds = bounds(costs, workers);
    Forecast {
        strategy: contender.name.clone(),
        workers,
        makespan_s,
        speedup,
        efficiency: speedup / workers.max(1) as f64,
        share_s: bounds.share_s,
        longest_s: bounds.longest_s,
        greedy_s: bounds.greedy_s,
    }
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

    #[test]
    fn rows_by_hand() {
        let serial = Contender {
            name: "in order".to_owned(),
            discipline: Discipline::InOrder,
            order: Order::ByIndex,
            overheads: Overheads::default(),
        };
        let contenders = [serial, Contender::longest_first()];
        let rows = forecast(&[1.0, 1.0, 2.0], &contenders, &[2, 4], &Hardware::default());
        let seen: Vec<_> = rows.iter().map(|r| (r.workers, r.makespan_s, r.speedup, r.efficiency, r.share_s)).collect();
        assert_eq!(seen, [(1, 4.0, 1.0, 1.0, 4.0), (2, 2.0, 2.0, 1.0, 2.0), (4, 2.0, 2.0, 0.5, 1.0)]);
        assert!(rows.iter().all(|row| row.longest_s == 2.0));
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
