//! Counters of the processor, for rows that ask for them (`counters = true`).
//!
//! The kernel counts for this thread and for those that it starts from now on (`perf_event_open` with `inherit`), so
//! counters are opened before a strategy starts its pool. Each new thread takes a copy of them, and each switch between
//! threads saves them. That slows strategies that start many threads. Counters are therefore a setting, and rows with
//! and without them are no repetitions of each other.

// Each system has a file with the same functions. Only Linux has counters, and `perf-event` knows few
// architectures.
#[cfg(not(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "riscv64"))))]
mod none;
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "riscv64")))]
mod perf;

#[cfg(not(all(
    target_os = "linux",
    any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "riscv64")
)))]
pub(super) use none::Counters;
#[cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64", target_arch = "riscv64")))]
pub(super) use perf::Counters;

/// The counters, by name; those of a row stand in this order.
pub(super) const COUNTERS: [&str; 4] = ["cycles", "instructions", "cache misses", "branch misses"];

/// A value for each counter; `None` where the system does not count.
pub(super) type Counted = [Option<u64>; COUNTERS.len()];

/// A counter's state: events, and the nanoseconds for which it was wanted and for which it ran. The processor has few
/// counters, which take turns if more are wanted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    events: u64,
    wanted_ns: u64,
    ran_ns: u64,
}

impl Reading {
    /// The events since `before`, scaled to the time for which they were wanted. `None` if the counter never ran.
    fn since(self, before: Self) -> Option<u64> {
        let [events, wanted, ran] = [
            self.events.checked_sub(before.events)?,
            self.wanted_ns.checked_sub(before.wanted_ns)?,
            self.ran_ns.checked_sub(before.ran_ns).filter(|ran| *ran > 0)?,
        ];
        u64::try_from(u128::from(events) * u128::from(wanted) / u128::from(ran)).ok()
    }
}

/// The events between two readings.
pub(super) fn between(before: &Readings, after: &Readings) -> Counted {
    std::array::from_fn(|place| after[place]?.since(before[place]?))
}

/// A reading of each counter; `None` where there is none.
pub(super) type Readings = [Option<Reading>; COUNTERS.len()];

#[cfg(test)]
mod tests {
    use super::*;

    /// A counter that ran for half of the time has seen half of the events.
    #[test]
    fn counters_that_took_turns_are_scaled() {
        let before = Reading { events: 100, wanted_ns: 10, ran_ns: 10 };
        let after = Reading { events: 600, wanted_ns: 2010, ran_ns: 1010 };
        assert_eq!(after.since(before), Some(1000));
        assert_eq!(before.since(before), None);
        let (before, after) = ([Some(before), None, Some(before), None], [Some(after), Some(after), None, None]);
        assert_eq!(between(&before, &after), [Some(1000), None, None, None]);
    }
}
