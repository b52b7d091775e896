//! The table of a simulation: every contender on every number of workers, beside the bounds.

use super::bounds::bounds;
use super::contender::Contender;
use super::hardware::Hardware;
use crate::strategy::Discipline;
use serde::{Deserialize, Serialize};

/// A row of the table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Forecast {
    /// The contender's name.
    pub strategy: String,
    /// Workers; processors, for a thread per job.
    pub workers: usize,
    /// Seconds until all jobs are done.
    pub makespan_s: f64,
    /// The sum of all costs over the makespan: the reference is the jobs in sequence, without overhead.
    pub speedup: f64,
    /// Speedup per worker.
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
}
