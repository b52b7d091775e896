//! Schedules paired with the serial runs of the same image in the same repetition.

use super::results::Results;
use super::rows::{Row, unique};
use super::schedule::Schedule;
use super::words::Told;
use crate::analysis::Estimate;
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::quantile::median;
use crate::error::Result;
use crate::measure::{ImageKey, ScheduleKey};
use std::collections::BTreeMap;

type Key = (ImageKey, ScheduleKey, u32);

/// The schedules of an experiment, and the serial runs that they are compared with.
pub(super) struct Serial<'a> {
    schedules: BTreeMap<&'a Schedule, Vec<&'a Row>>,
    /// The serial runs, by image, pieces and repetition.
    on_pieces: BTreeMap<Key, &'a Row>,
    /// The fastest time over all pieces, by image and repetition.
    fastest: BTreeMap<Key, f64>,
    stopping: Stopping,
}

/// The key that a row shares with the serial run on the same pieces.
fn with_pieces(row: &Row) -> Key {
    row.key(|_, schedule| schedule.forget_workers())
}

/// The key that a row shares with all serial runs of its image.
fn without_pieces(row: &Row) -> Key {
    let mut key = with_pieces(row);
    key.1.decomposition.clear();
    key
}

impl<'a> Serial<'a> {
    pub(super) fn of(results: &'a Results) -> Result<Self> {
        let schedules = results.by_schedule();
        let serial: Vec<&Row> =
            schedules.iter().filter(|(s, _)| s.is_serial()).flat_map(|(_, rows)| rows.iter().copied()).collect();
        let mut fastest = BTreeMap::new();
        for row in &serial {
            if let Some(time) = row.makespan_s {
                fastest
                    .entry(without_pieces(row))
                    .and_modify(|least: &mut f64| *least = least.min(time))
                    .or_insert(time);
            }
        }
        Ok(Self { on_pieces: unique(serial, with_pieces)?, fastest, schedules, stopping: results.stopping() })
    }

    /// All schedules except the serial ones.
    pub(super) fn others(&self) -> impl Iterator<Item = &'a Schedule> {
        self.schedules.keys().copied().filter(|schedule| !schedule.is_serial())
    }

    /// The rows of a schedule.
    pub(super) fn rows(&self, schedule: &Schedule) -> &[&'a Row] {
        self.schedules.get(schedule).map_or(&[], Vec::as_slice)
    }

    /// Pairs each run of a schedule with the serial run on the same pieces.
    pub(super) fn pairs(&self, schedule: &Schedule) -> impl Iterator<Item = (&'a Row, &'a Row)> {
        self.rows(schedule).iter().filter_map(|row| Some((*row, *self.on_pieces.get(&with_pieces(row))?)))
    }

    /// Pairs each run that is not serial with the serial run on the same pieces, in the order of the rows.
    pub(super) fn in_order(&self, results: &'a Results) -> impl Iterator<Item = (&'a Row, &'a Row)> {
        let others = results.rows().filter(|row| !row.schedule.is_serial());
        others.filter_map(|row| Some((row, *self.on_pieces.get(&with_pieces(row))?)))
    }

    /// The serial runs that are paired with the runs of a schedule.
    pub(super) fn on_pieces_of(&self, schedule: &Schedule) -> Vec<&'a Row> {
        self.pairs(schedule).map(|(_, serial)| serial).collect()
    }

    /// The speedups of a schedule against `serial` on the same pieces, one for each image and repetition that both have.
    pub(super) fn paired_speedups(&self, schedule: &Schedule) -> Vec<f64> {
        self.pairs(schedule).filter_map(|(own, serial)| Some(serial.makespan_s? / own.makespan_s?)).collect()
    }

    /// The speedup of each schedule: the median of the ratios to `serial` for the same image in the same repetition.
    pub(super) fn speedups(&self) -> Vec<(&'a Schedule, Estimate)> {
        let speedup = |schedule: &'a Schedule| {
            // Prefer the serial run on the same pieces: other pieces change at least the caches.
            let mut ratios = self.paired_speedups(schedule);
            if ratios.is_empty() {
                let to_fastest = |row: &&Row| Some(self.fastest.get(&without_pieces(row))? / row.makespan_s?);
                ratios = self.rows(schedule).iter().filter_map(to_fastest).collect();
            }
            Some((schedule, Told::median(&ratios, self.stopping)?.estimate()?))
        };
        self.others().filter_map(speedup).collect()
    }

    /// CPU time of a schedule over that of `serial` on the same pieces in the same repetition: the median of the
    /// ratios. It shows how much more the same work costs on several processors, plus the cost of the schedule itself.
    pub(super) fn work_inflation(&self, schedule: &Schedule) -> Option<f64> {
        let ratios = self.pairs(schedule).filter_map(|(own, serial)| Some(own.cpu_s()? / serial.cpu_s()?));
        median(&ratios.collect::<Vec<f64>>())
    }
}
