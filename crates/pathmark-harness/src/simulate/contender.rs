//! Contenders of a forecast: strategies of the table with their costs on this machine, and an ideal one for comparison.

use super::forecast::longest_first;
use super::hardware::Hardware;
use super::overhead::Overheads;
use super::replay::{Replay, replay};
use crate::analysis::quantile::median;
use crate::lab::Lab;
use crate::measure::CalibrationRow;
use crate::strategy::{ChunkRule, Discipline};
use std::collections::BTreeMap;

/// A discipline with a name and its mechanism's cost.
#[derive(Debug, Clone)]
pub struct Contender {
    /// The name in tables: a strategy with its parameter if it has one.
    pub name: String,
    pub discipline: Discipline,
    pub order: Order,
    pub overheads: Overheads,
    /// The costs by each of several calibrations; empty if there was one.
    pub calibrations: Vec<Overheads>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    ByIndex,
    /// The longest first, which requires all costs to be known beforehand.
    LongestFirst,
}

/// The name of [`Contender::longest_first`].
pub const LONGEST_FIRST: &str = "longest-first";

impl Contender {
    /// The longest job first, one at a time, at no cost (LPT; Graham 1969). No strategy of the table can do that, since
    /// none knows the costs beforehand: this contender shows the value of knowing them.
    pub fn longest_first() -> Self {
        Self {
            name: LONGEST_FIRST.to_owned(),
            discipline: Discipline::Chunks(ChunkRule { size: |_| 1, parameter: 1 }),
            order: Order::LongestFirst,
            overheads: Overheads::default(),
            calibrations: Vec::new(),
        }
    }

    /// The contender with the costs by each calibration, or itself if there was one.
    pub fn by_calibration(&self) -> Vec<Self> {
        let with =
            |overheads: &Overheads| Self { overheads: overheads.clone(), calibrations: Vec::new(), ..self.clone() };
        if self.calibrations.is_empty() { vec![self.clone()] } else { self.calibrations.iter().map(with).collect() }
    }

    /// Whether each job has its own thread, so that a worker is not a processor.
    pub fn has_a_thread_per_job(&self) -> bool {
        matches!(self.discipline, Discipline::AllAtOnce)
    }

    /// Replays jobs of these costs, in seconds and in index order. The spans are in index order too, whatever the order
    /// of execution.
    pub fn replay(&self, costs: &[f64], workers: usize, hardware: &Hardware) -> Replay {
        let overhead = self.overheads.at(workers);
        let order = match self.order {
            Order::ByIndex => return replay(costs, self.discipline, workers, &overhead, hardware),
            Order::LongestFirst => longest_first(costs),
        };
        let sorted: Vec<f64> = order.iter().map(|&job| costs[job]).collect();
        let mut replayed = replay(&sorted, self.discipline, workers, &overhead, hardware);
        let mut spans = replayed.trace.jobs.clone();
        for (span, job) in replayed.trace.jobs.into_iter().zip(order) {
            spans[job] = span;
        }
        replayed.trace.jobs = spans;
        replayed
    }
}

/// Contenders for the strategies in `rows`, in the order of their first row; strategies that this build lacks are left
/// out. Their costs are those of the median times over all calibrations; those by each calibration are kept beside them.
///
/// Rules with too few chunks to be timed take their cost per chunk from the cheapest rule that hands out single jobs.
/// Starting a thread costs the same under every strategy, so strategies that start their workers in the run share the
/// median of their fitted costs.
pub fn contenders(lab: &Lab, rows: &[CalibrationRow]) -> Vec<Contender> {
    let schedules = gathered(rows, |row| (row.strategy.as_str(), row.threads, row.jobs));
    let typical: Vec<CalibrationRow> = schedules.iter().filter_map(|rows| CalibrationRow::median(rows)).collect();
    let mut contenders = calibrated(lab, &typical);
    let calibrations = gathered(rows, |row| row.calibration);
    if calibrations.len() > 1 {
        for rows in calibrations {
            let rows: Vec<CalibrationRow> = rows.into_iter().cloned().collect();
            let of_one = calibrated(lab, &rows);
            for contender in &mut contenders {
                let own = of_one.iter().find(|own| own.name == contender.name);
                contender.calibrations.extend(own.map(|own| own.overheads.clone()));
            }
        }
    }
    contenders
}

/// The rows by their keys, in the order of each key's first row.
fn gathered<'a, K: Ord>(
    rows: &'a [CalibrationRow],
    key: impl Fn(&'a CalibrationRow) -> K,
) -> Vec<Vec<&'a CalibrationRow>> {
    let mut groups: BTreeMap<K, (usize, Vec<&CalibrationRow>)> = BTreeMap::new();
    for (index, row) in rows.iter().enumerate() {
        groups.entry(key(row)).or_insert_with(|| (index, Vec::new())).1.push(row);
    }
    let mut groups: Vec<(usize, Vec<&CalibrationRow>)> = groups.into_values().collect();
    groups.sort_by_key(|(first, _)| *first);
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Contenders from one row of each schedule.
fn calibrated(lab: &Lab, rows: &[CalibrationRow]) -> Vec<Contender> {
    let mut contenders: Vec<Contender> = Vec::new();
    for row in rows {
        if contenders.iter().any(|contender| contender.name == row.strategy) {
            continue;
        }
        let Ok((entry, parameter)) = lab.strategy_named(&row.strategy) else { continue };
        let Ok(discipline) = entry.discipline(parameter.as_deref()) else { continue };
        let overheads = Overheads::fit(rows.iter().filter(|other| other.strategy == row.strategy), discipline);
        let (name, order) = (row.strategy.clone(), Order::ByIndex);
        contenders.push(Contender { name, discipline, order, overheads, calibrations: Vec::new() });
    }
    let known = contenders.iter().filter(|contender| matches!(contender.discipline, Discipline::Chunks(_)));
    let known = known.filter_map(|contender| contender.overheads.place.as_ref());
    let cheapest = known.min_by(|a, b| a.take_s.total_cmp(&b.take_s)).cloned();
    for contender in &mut contenders {
        contender.overheads.place = contender.overheads.place.take().or_else(|| cheapest.clone());
    }
    share_the_start(&mut contenders, rows);
    contenders
}

fn share_the_start(contenders: &mut [Contender], rows: &[CalibrationRow]) {
    let starts_workers = |contender: &Contender| {
        let own = rows.iter().filter(|row| row.strategy == contender.name);
        !contender.has_a_thread_per_job() && own.clone().all(|row| row.started == row.threads) && own.count() > 0
    };
    let (mut starters, _): (Vec<&mut Contender>, Vec<_>) = contenders.iter_mut().partition(|one| starts_workers(one));
    let starts: Vec<f64> = starters.iter().map(|contender| contender.overheads.start_s).collect();
    if let Some(start_s) = median(&starts) {
        for contender in &mut starters {
            contender.overheads.start_s = start_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strategy::STRATEGIES;

    /// Rows of a machine on which every strategy costs the same.
    fn rows() -> Vec<CalibrationRow> {
        let row = |strategy: &str, threads: usize, jobs: usize| CalibrationRow {
            strategy: strategy.to_owned(),
            threads,
            jobs,
            seconds: 1e-5 * threads as f64 + 1e-8 * jobs as f64,
            cpu_s: None,
            started: 0,
            calibration: 0,
        };
        let of = |name| [(1, 200), (1, 4000), (2, 200), (2, 4000)].map(|(threads, jobs)| row(name, threads, jobs));
        STRATEGIES.iter().flat_map(|entry| of(entry.name)).collect()
    }

    #[test]
    fn every_strategy_competes_and_pays_for_its_chunks() {
        let contenders = contenders(&Lab::new(), &rows());
        assert_eq!(contenders.len(), STRATEGIES.len());
        for contender in &contenders {
            let at = contender.overheads.at(2);
            assert!(contender.overheads.place.is_some(), "{}", contender.name);
            let pays = at.take_s > 0.0 && at.shared_s > 0.0;
            assert!(pays || !matches!(contender.discipline, Discipline::Chunks(_)), "{}: {at:?}", contender.name);
        }
    }

    /// Three strategies whose workers are threads, at 10, 20 and 90 microseconds, and a pool.
    #[test]
    fn a_thread_costs_the_same_whoever_starts_it() {
        let of = |strategy: &str, start_s: f64, pool: bool| {
            [1, 2].map(|threads| CalibrationRow {
                started: if pool { 0 } else { threads },
                ..CalibrationRow::of_starts(strategy, threads, start_s)
            })
        };
        let rows = [
            of("static-blocks", 1e-5, false),
            of("static-cyclic", 2e-5, false),
            of("steal-half", 9e-5, false),
            of("rayon-join", 1e-6, true),
        ];
        let contenders = contenders(&Lab::new(), rows.as_flattened());
        let starts: Vec<f64> = contenders.iter().map(|contender| contender.overheads.at(2).start_s).collect();
        assert!(starts[..3].iter().all(|start| (start - 2e-5).abs() < 1e-12), "{starts:?}");
        assert!((starts[3] - 1e-6).abs() < 1e-12, "{starts:?}");
    }

    /// Three calibrations in which a thread takes 20, 85 and 30 microseconds to start.
    #[test]
    fn each_calibration_has_its_own_costs() {
        let of = |calibration: u32, start_s: f64| {
            [1, 2].map(|threads| CalibrationRow {
                calibration,
                ..CalibrationRow::of_starts("static-blocks", threads, start_s)
            })
        };
        let rows = [of(0, 2e-5), of(1, 8.5e-5), of(2, 3e-5)];
        let starts = |contenders: &[Contender]| -> Vec<f64> {
            contenders.iter().map(|contender| contender.overheads.at(2).start_s * 1e6).collect()
        };
        let found = contenders(&Lab::new(), rows.as_flattened());
        let [one] = &found[..] else { panic!("{found:?}") };
        let close = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(close(&starts(&found), &[30.0]), "{found:?}");
        assert!(close(&starts(&one.by_calibration()), &[20.0, 85.0, 30.0]), "{found:?}");
        let alone = contenders(&Lab::new(), &rows[1]);
        assert!(alone[0].calibrations.is_empty() && close(&starts(&alone[0].by_calibration()), &[85.0]));
    }

    #[test]
    fn a_row_of_no_strategy_is_left_out() {
        let wrong = |strategy: &str| CalibrationRow { strategy: strategy.to_owned(), ..rows()[0].clone() };
        let found = contenders(&Lab::new(), &["no-such-strategy", "dynamic:x", "dynamic:4"].map(wrong));
        let names: Vec<&str> = found.iter().map(|contender| contender.name.as_str()).collect();
        assert_eq!(names, ["dynamic:4"]);
    }

    #[test]
    fn longest_first_keeps_the_jobs_spans_apart() {
        let costs = [1.0, 4.0, 2.0];
        let replayed = Contender::longest_first().replay(&costs, 2, &Hardware::default());
        assert_eq!(replayed.makespan_s, 4.0);
        let durations: Vec<f64> = replayed.trace.jobs.iter().map(crate::measure::JobSpan::duration_s).collect();
        assert_eq!(durations, costs);
    }
}
