//! Many cases at once.

use super::{Case, Effort, Outcome};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use std::thread;

/// Tries the cases on so many threads. `told` hears how many are done. The outcomes are in the cases' order.
pub fn run(cases: &[&'static Case], effort: Effort, threads: usize, told: &dyn Fn(u64)) -> Vec<Outcome> {
    let next = AtomicUsize::new(0);
    let mut outcomes: Vec<(usize, Outcome)> = Vec::with_capacity(cases.len());
    thread::scope(|scope| {
        let (sender, receiver) = channel();
        for _ in 0..threads.max(1) {
            let (sender, next) = (sender.clone(), &next);
            scope.spawn(move || {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(index) else { break };
                    // Whoever collects has gone only if it panicked, and then nobody asks.
                    let _ = sender.send((index, case.run(effort)));
                }
            });
        }
        drop(sender);
        for found in receiver {
            outcomes.push(found);
            told(outcomes.len() as u64);
        }
    });
    outcomes.sort_by_key(|(index, _)| *index);
    outcomes.into_iter().map(|(_, outcome)| outcome).collect()
}
