//! Batches: runs that are too short to be timed alone follow each other, and the mean counts. Reading the clock and a single
//! interruption then weigh less. The start of a schedule's threads weighs as before: each run has its own.

use super::Record;
use super::run::shortest_s;
use super::warning::Warning;

/// The duration of a batch over that of the shortest run: a margin, since the machine may get faster.
const MARGIN: f64 = 1.5;
/// Most runs of a batch: a run may take no time that the clock can show.
const MOST: f64 = 1000.0;

/// The number of runs for a batch, if one of them takes that many seconds.
pub fn batch_runs(run_s: f64, is_serial: bool) -> u32 {
    let batch_s = MARGIN * shortest_s(is_serial);
    if run_s >= batch_s { 1 } else { (batch_s / run_s).ceil().min(MOST) as u32 }
}

impl Record {
    /// The row of a batch: measurements are means over its rows, and whatever does not change from run to run is that of the
    /// first. `None` without rows, or if two images differ.
    pub fn of_batch(rows: &[Self]) -> Option<Self> {
        let first = rows.first().filter(|first| rows.iter().all(|row| row.checksum == first.checksum))?;
        let mut batch = Self { runs: u32::try_from(rows.len()).ok(), ..first.clone() };
        macro_rules! means {
            ($($column:ident)+) => { $(
                batch.$column = mean(rows, |row| row.$column.map(|value| value as f64)).map(|mean| mean as _);
            )+ };
        }
        means! {
            pilot_s strategy_setup_s makespan_s merge_s time_to_image_s cpu_user_s cpu_system_s busy_sum_s busy_max_s
            idle_between_jobs_s idle_before_first_job_s idle_tail_s job_min_s job_median_s job_max_s voluntary_switches
            involuntary_switches other_cpu_s steal_s migrations cycles instructions cache_misses branch_misses
        }
        let shortest_s = shortest_s(first.is_serial());
        if batch.makespan_s.is_some_and(|run_s| run_s * rows.len() as f64 >= shortest_s) {
            let short = Warning::TooShort.to_string();
            let others: Vec<&str> = first.warnings.split(';').filter(|warning| *warning != short).collect();
            batch.warnings = others.join(";");
        }
        Some(batch)
    }
}

/// `None` if a row lacks the value.
fn mean(rows: &[Record], value: impl Fn(&Record) -> Option<f64>) -> Option<f64> {
    let sum: Option<f64> = rows.iter().map(value).sum();
    Some(sum? / rows.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::SERIAL;

    fn run(makespan_s: f64) -> Record {
        Record {
            makespan_s: Some(makespan_s),
            cycles: Some((1e9 * makespan_s) as u64),
            rays: Some(7),
            warnings: "biased;too-short".to_string(),
            ..Record::default()
        }
    }

    #[test]
    fn a_batch_lasts_as_long_as_can_be_timed() {
        let runs =
            |is_serial| [1.0, 0.05, 7.5e-3, 7.4e-3, 3e-3, 1e-3, 1e-9, 0.0].map(|run_s| batch_runs(run_s, is_serial));
        assert_eq!(runs(false), [1, 1, 1, 2, 3, 8, 1000, 1000]);
        assert_eq!(runs(true), [1, 1, 1, 1, 1, 3, 1000, 1000]);
    }

    #[test]
    fn times_are_means_and_counts_of_the_image_stay() {
        let batch = Record::of_batch(&[run(0.001), run(0.004), run(0.004)]).unwrap();
        assert!((batch.makespan_s.unwrap() - 0.003).abs() < 1e-12);
        assert_eq!((batch.cycles, batch.rays, batch.runs), (Some(3_000_000), Some(7), Some(3)));
        assert_eq!(batch.warnings, "biased");
        let short = Record::of_batch(&[run(0.001)]).unwrap();
        assert_eq!((short.makespan_s, short.warnings.as_str()), (Some(0.001), "biased;too-short"));
        let serial = |makespan_s| Record { strategy: SERIAL.to_string(), ..run(makespan_s) };
        assert_eq!(Record::of_batch(&[serial(0.001), serial(0.001)]).unwrap().warnings, "biased");
        assert_eq!(Record::of_batch(&[run(0.001), run(0.001)]).unwrap().warnings, "biased;too-short");
    }

    #[test]
    fn a_batch_has_one_image() {
        let other = Record { checksum: "other".to_string(), ..run(0.001) };
        assert_eq!(Record::of_batch(&[run(0.001), other]), None);
        assert_eq!(Record::of_batch(&[]), None);
    }
}
