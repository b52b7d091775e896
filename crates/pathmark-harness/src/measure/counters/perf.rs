//! Linux counts by `perf_event_open`.

use super::{COUNTERS, Reading, Readings};
use perf_event::{Builder, Counter, events::Event, events::Hardware};

/// The open counters of this thread and of threads that it starts later.
pub(in crate::measure) struct Counters([Option<Counter>; COUNTERS.len()]);

impl Counters {
    /// Opens those that the system grants.
    pub(in crate::measure) fn open() -> Self {
        let events = [Hardware::CPU_CYCLES, Hardware::INSTRUCTIONS, Hardware::CACHE_MISSES, Hardware::BRANCH_MISSES];
        Self(events.map(|event| open(event.into())))
    }

    pub(in crate::measure) fn read(&mut self) -> Readings {
        self.0.each_mut().map(|counter| {
            let read = counter.as_mut()?.read_count_and_time().ok()?;
            Some(Reading { events: read.count, wanted_ns: read.time_enabled, ran_ns: read.time_running })
        })
    }
}

fn open(event: Event) -> Option<Counter> {
    let mut builder = Builder::new().kind(event);
    builder.inherit(true).enabled(true);
    builder.build().ok()
}

#[cfg(test)]
mod tests {
    use super::super::between;
    use super::*;
    use perf_event::events::Software;

    /// Page faults are counted in virtual machines, too. The thread touches a page that nobody has touched before.
    #[test]
    fn later_threads_are_counted() {
        let Some(faults) = open(Software::PAGE_FAULTS_MIN.into()) else { return };
        let mut counters = Counters([Some(faults), None, None, None]);
        let before = counters.read();
        let touched = std::thread::spawn(|| vec![1_u8; 16 << 20].iter().map(|byte| u64::from(*byte)).sum::<u64>());
        assert_eq!(touched.join().unwrap(), 16 << 20);
        let [faults, ..] = between(&before, &counters.read());
        assert!(faults.is_some_and(|faults| faults > 0), "{faults:?}");
    }
}
