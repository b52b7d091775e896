//! A thread for each job: all started threads share the processors equally.
//!
//! The operating system's scheduler as a fluid: with k threads on P processors, each thread always has the share min(1,
//! P/k) of a processor. That is generalized processor sharing (Parekh and Gallager, IEEE/ACM Transactions on Networking
//! 1(3), 1993), which Linux's fair schedulers approximate by time slices. Of unequal processors the fastest are used,
//! and every thread gets the same share of each.
//!
//! Virtual time makes the replay fast: it advances by the processor time that one thread gets. A thread that starts at
//! virtual time v and needs c seconds therefore ends at v + c, whichever threads start or end meanwhile. One heap
//! yields all events in order. The caller counts as one more thread while it starts threads.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Replay;
use super::crew::Time;
use crate::measure::{JobSpan, Trace};
use crate::simulate::hardware::Hardware;
use crate::simulate::overhead::Overhead;

pub(super) fn replay(costs: &[f64], processors: usize, overhead: &Overhead, hardware: &Hardware) -> Replay {
    let capacity = capacity(&hardware.fastest_first(processors));
    let caller = costs.len();
    let (mut now_s, mut progress_s, mut started) = (overhead.run_s, 0.0, 0);
    let mut spans = vec![JobSpan::default(); costs.len()];
    let mut running = BinaryHeap::new();
    if !costs.is_empty() {
        running.push(Reverse((Time(overhead.start_s), caller)));
    }
    loop {
        let active = running.len();
        let Some(Reverse((Time(done_s), who))) = running.pop() else { break };
        let share = capacity[active.min(processors)] / active as f64;
        now_s += (done_s - progress_s) / share;
        progress_s = done_s;
        if who == caller {
            spans[started] = JobSpan { worker: started as u32, start_s: now_s, stop_s: now_s };
            running.push(Reverse((Time(progress_s + overhead.job_s + costs[started]), started)));
            started += 1;
            if started < costs.len() {
                running.push(Reverse((Time(progress_s + overhead.start_s), caller)));
            }
        } else {
            spans[who].stop_s = now_s;
        }
    }
    Replay { makespan_s: now_s, trace: Trace { jobs: spans } }
}

/// The total speed of the k fastest processors, for k from 0.
fn capacity(speeds: &[f64]) -> Vec<f64> {
    let sums = speeds.iter().scan(0.0, |sum, speed| {
        *sum += speed;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}
