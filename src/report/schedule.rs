//! A schedule as figures name it.

use super::words::counted;
use crate::lab::rank_rule;
use crate::measure::{Record, SERIAL, ScheduleKey, THREAD_PER_ROW, schedule_name};

/// A schedule with its name. Schedules are listed by name, then by pieces, then by threads.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Schedule {
    /// The strategy, `thread-per-row` as report A names it, and what else tells it from others of the experiment.
    pub(super) name: String,
    pub(super) key: ScheduleKey,
}

impl Schedule {
    /// Name and threads, in words.
    pub(super) fn label(&self) -> String {
        crew(&self.name, self.key.threads)
    }

    pub(super) fn is_serial(&self) -> bool {
        self.key.strategy == SERIAL
    }

    pub(super) fn is_thread_per_row(&self) -> bool {
        schedule_name(&self.key.strategy, &self.key.decomposition) == THREAD_PER_ROW
    }
}

/// Who renders, with how many threads or, if they are processes, ranks.
pub(super) fn crew(strategy: &str, threads: usize) -> String {
    let workers = if is_of_ranks(strategy) { "rank" } else { "thread" };
    format!("{strategy}, {}", counted(threads, workers))
}

/// Whether the workers of what has that name are processes.
pub(super) fn is_of_ranks(name: &str) -> bool {
    rank_rule(name.split_once(',').map_or(name, |(strategy, _)| strategy)).is_some()
}

/// The strategy of a row as report A names it.
pub(super) fn strategy(record: &Record) -> &str {
    schedule_name(&record.strategy, &record.decomposition)
}
