//! A schedule as figures name it.

use super::words::counted;
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

/// Who renders, with how many threads or, over processes, workers.
pub(super) fn crew(strategy: &str, threads: usize) -> String {
    let workers = if is_of_ranks(strategy) { "worker" } else { "thread" };
    format!("{strategy}, {}", counted(threads, workers))
}

/// What the names of strategies over processes begin with.
const OF_RANKS: &str = "mpi-";

/// Whether the workers of what has that name are processes.
pub(super) fn is_of_ranks(name: &str) -> bool {
    name.starts_with(OF_RANKS)
}

/// The row of processes with their rule in the place of the strategy, and with all workers over all of them, because figures compare them with
/// threads; `None` for a row of one process. Threads within processes are part of the name.
pub(super) fn over_ranks(record: &Record) -> Option<Record> {
    let ranks = record.ranks?;
    let within = match (record.threads, record.strategy.as_str()) {
        (1, _) => String::new(),
        (threads, strategy) => format!(", {threads} threads each by {strategy}"),
    };
    let strategy = format!("{OF_RANKS}{}{within}", record.rank_rule);
    let threads = record.threads * usize::from(ranks);
    Some(Record { strategy, threads, ranks: None, rank_rule: String::new(), ..record.clone() })
}

/// The strategy of a row as report A names it.
pub(super) fn strategy(record: &Record) -> &str {
    schedule_name(&record.strategy, &record.decomposition)
}
