//! Two operations timed in turns, so that a temporary slowdown of the machine affects both.

use crate::analysis::quantile::median;
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Minimum duration of one round of either: far above a clock's resolution.
const ROUND: Duration = Duration::from_millis(2);
/// Doublings after which an operation counts as too quick to be timed.
const MOST_DOUBLINGS: u32 = 40;

/// The times of one process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interleaved {
    /// Median nanoseconds per operation of the first.
    pub first_ns: f64,
    pub second_ns: f64,
    /// First over second, round by round.
    pub ratios: Vec<f64>,
}

/// Times both in `rounds` rounds: each is called once per round, and they take turns to be called first. The argument
/// of a call is the number of operations to run. `None` for no rounds.
pub fn interleaved(rounds: usize, first: &mut dyn FnMut(u64), second: &mut dyn FnMut(u64)) -> Option<Interleaved> {
    let of_first = operations(|count| time(first, count));
    let of_second = operations(|count| time(second, count));
    let mut times: Vec<[f64; 2]> = Vec::with_capacity(rounds);
    for round in 0..rounds {
        times.push(if round % 2 == 0 {
            let a = ns_per_operation(first, of_first);
            [a, ns_per_operation(second, of_second)]
        } else {
            let b = ns_per_operation(second, of_second);
            [ns_per_operation(first, of_first), b]
        });
    }
    let column = |index: usize| times.iter().map(|row| row[index]).collect::<Vec<f64>>();
    Some(Interleaved {
        first_ns: median(&column(0))?,
        second_ns: median(&column(1))?,
        ratios: times.iter().map(|[a, b]| a / b).collect(),
    })
}

fn operations(mut time: impl FnMut(u64) -> Duration) -> u64 {
    let counts = (0..MOST_DOUBLINGS).map(|power| 1_u64 << power);
    counts.into_iter().find(|count| time(*count) >= ROUND).unwrap_or(1 << MOST_DOUBLINGS)
}

fn time(work: &mut dyn FnMut(u64), count: u64) -> Duration {
    let before = Instant::now();
    work(count);
    before.elapsed()
}

fn ns_per_operation(work: &mut dyn FnMut(u64), count: u64) -> f64 {
    time(work, count).as_secs_f64() * 1e9 / count as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::thread::sleep;

    /// Checks the order of the calls, with operations that are long enough to be timed at once.
    #[test]
    fn either_goes_first_by_turns() {
        let calls = RefCell::new(String::new());
        let call = |who: char| {
            let calls = &calls;
            move |count: u64| {
                assert_eq!(count, 1);
                calls.borrow_mut().push(who);
                sleep(ROUND);
            }
        };
        let found = interleaved(6, &mut call('a'), &mut call('b')).unwrap();
        assert_eq!(*calls.borrow(), "ababbaabbaabba");
        assert!(found.ratios.len() == 6 && found.first_ns >= 2e6 && found.second_ns >= 2e6);
        assert_eq!(interleaved(0, &mut call('a'), &mut call('b')), None);
    }

    /// Quick operations are run twice as often each time, until they can be timed.
    #[test]
    fn quick_work_is_repeated() {
        assert_eq!(operations(|count| Duration::from_micros(100 * count)), 32);
        assert_eq!(operations(|_| Duration::from_secs(1)), 1);
        assert_eq!(operations(|_| Duration::ZERO), 1 << MOST_DOUBLINGS);
    }
}
