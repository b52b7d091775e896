//! Counters of the processor, for rows that ask for them (`counters = true`).
//!
//! The kernel counts for this thread and for those that it starts from now on (`perf_event_open` with `inherit`), so
//! counters are opened before a strategy starts its pool. Each new thread takes a copy of them, and each switch between
//! threads saves them. That slows strategies that start many threads. Counters are therefore a setting, and rows with
//! and without them are no repetitions of each other.

// `perf_event_open` is a system call of Linux alone.
#[cfg(target_os = "linux")]
use perf_event::{Builder, Counter, events::Event, events::Hardware};

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

/// The open counters of this thread and of threads that it starts later.
#[cfg(target_os = "linux")]
pub(super) struct Counters([Option<Counter>; COUNTERS.len()]);

#[cfg(target_os = "linux")]
impl Counters {
    /// Opens those that the system grants.
    pub(super) fn open() -> Self {
        let events = [Hardware::CPU_CYCLES, Hardware::INSTRUCTIONS, Hardware::CACHE_MISSES, Hardware::BRANCH_MISSES];
        Self(events.map(|event| open(event.into())))
    }

    pub(super) fn read(&mut self) -> Readings {
        self.0.each_mut().map(|counter| {
            let read = counter.as_mut()?.read_count_and_time().ok()?;
            Some(Reading { events: read.count, wanted_ns: read.time_enabled, ran_ns: read.time_running })
        })
    }
}

#[cfg(target_os = "linux")]
fn open(event: Event) -> Option<Counter> {
    let mut builder = Builder::new().kind(event);
    builder.inherit(true).enabled(true);
    builder.build().ok()
}

/// Other systems have no such counters for programs.
#[cfg(not(target_os = "linux"))]
pub(super) struct Counters;

#[cfg(not(target_os = "linux"))]
impl Counters {
    pub(super) fn open() -> Self {
        Self
    }

    pub(super) fn read(&mut self) -> Readings {
        Readings::default()
    }
}

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

    /// Page faults are counted in virtual machines, too. The thread touches a page that nobody has touched before.
    #[cfg(target_os = "linux")]
    #[test]
    fn later_threads_are_counted() {
        use perf_event::events::Software;
        let Some(faults) = open(Software::PAGE_FAULTS_MIN.into()) else { return };
        let mut counters = Counters([Some(faults), None, None, None]);
        let before = counters.read();
        let touched = std::thread::spawn(|| vec![1_u8; 16 << 20].iter().map(|byte| u64::from(*byte)).sum::<u64>());
        assert_eq!(touched.join().unwrap(), 16 << 20);
        let [faults, ..] = between(&before, &counters.read());
        assert!(faults.is_some_and(|faults| faults > 0), "{faults:?}");
    }
}
