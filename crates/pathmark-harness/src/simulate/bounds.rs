//! Bounds on makespans: a lower one for every schedule, an upper one for greedy schedules.
//!
//! Graham, "Bounds for certain multiprocessing anomalies", Bell System Technical Journal 45(9), 1966: a schedule that never leaves a
//! worker idle while a job waits ends at W/P + (1 - 1/P) L at the latest, for work W, longest job L and P equal workers; since no
//! schedule ends before W/P or before L, that is at most 2 - 1/P times the best. Graham, "Bounds on multiprocessing timing anomalies",
//! SIAM Journal on Applied Mathematics 17(2), 1969: with the longest jobs first, it is at most 4/3 - 1/(3P) times the best.

/// The bounds for jobs without overheads on equal workers of speed 1, in seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The time of all jobs, shared evenly: W/P.
    pub share_s: f64,
    /// The longest job's time.
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
    use super::*;

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
