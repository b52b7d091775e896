//! Schedules and their names in figures.

use crate::measure::{Record, SERIAL, ScheduleKey, THREAD_PER_ROW, schedule_name};
use crate::words::counted;

/// A schedule with its name. Schedules are listed by name, then by pieces, then by threads.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Schedule {
    /// The strategy (`thread-per-row` is report A's name), and the other properties that distinguish it within the
    /// experiment.
    pub(crate) name: String,
    pub(crate) key: ScheduleKey,
}

impl Schedule {
    /// Name and threads, in words.
    pub(crate) fn label(&self) -> String {
        crew(&self.name, self.key.threads)
    }

    pub(crate) fn is_serial(&self) -> bool {
        self.key.strategy == SERIAL
    }

    pub(crate) fn is_thread_per_row(&self) -> bool {
        schedule_name(&self.key.strategy, &self.key.decomposition) == THREAD_PER_ROW
    }
}

/// A strategy and its number of threads (of workers, if they are processes), in words.
pub(crate) fn crew(strategy: &str, threads: usize) -> String {
    let workers = if is_of_ranks(strategy) { "worker" } else { "thread" };
    format!("{strategy}, {}", counted(threads, workers))
}

/// Prefix of the names of strategies over processes.
const OF_RANKS: &str = "mpi-";

/// Whether the strategy of that name runs on processes.
pub(crate) fn is_of_ranks(name: &str) -> bool {
    name.starts_with(OF_RANKS)
}

/// Rewrites the row of several processes so that figures can compare it with threads: the rank rule takes the place of
/// the strategy, and the threads of all processes are added up. The name includes the threads within a process. `None`
/// for a row of one process.
pub(crate) fn over_ranks(record: &Record) -> Option<Record> {
    let ranks = record.ranks?;
    let within = match (record.threads, record.strategy.as_str()) {
        (1, _) => String::new(),
        (threads, strategy) => format!(", {threads} threads each by {strategy}"),
    };
    let strategy = format!("{OF_RANKS}{}{within}", record.rank_rule);
    let threads = record.threads * usize::from(ranks);
    Some(Record { strategy, threads, ranks: None, rank_rule: String::new(), ..record.clone() })
}

/// The strategy of a row, with report A's name where it has one.
pub(crate) fn strategy(record: &Record) -> &str {
    schedule_name(&record.strategy, &record.decomposition)
}
