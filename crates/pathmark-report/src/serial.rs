//! Schedules paired with the serial runs of the same image in the same repetition.

use super::rows::paired::Pairs;
use crate::prelude::*;

/// The schedules of an experiment, and the serial runs that they are compared with.
pub(super) struct Serial<'a> {
    schedules: BTreeMap<&'a Schedule, Vec<&'a Row>>,
    /// The serial runs on the same pieces.
    pub(super) on_pieces: Partners<'a>,
    /// The fastest serial runs over all pieces.
    pub(super) fastest: Partners<'a>,
    stopping: Stopping,
    /// Width and height of most images.
    usual_size: Option<(u32, u32)>,
    /// Whether lines are named by their pieces. One decomposition, with the rows of report A beside it, needs no name.
    names_pieces: bool,
}

/// A line of a chart: the threads of its points, and the speedups of each.
pub(super) type Line = Vec<(usize, Vec<f64>)>;

/// Keeps the properties that a row shares with the serial run on the same pieces.
pub(super) fn with_pieces(_: &mut ImageKey, schedule: &mut ScheduleKey) {
    schedule.forget_workers();
}

/// Keeps the properties that a row shares with all serial runs of its image.
pub(super) fn without_pieces(_: &mut ImageKey, schedule: &mut ScheduleKey) {
    schedule.forget_workers();
    schedule.decomposition.clear();
}

impl Results {
    pub(super) fn serial(&self) -> Result<Serial<'_>> {
        let schedules = self.by(|row| &row.schedule);
        let serial = || schedules.iter().filter(|(s, _)| s.is_serial()).flat_map(|(_, rows)| rows.iter().copied());
        let sizes = self.by(|row| (row.width, row.height)).into_iter();
        let others = schedules.keys().filter(|schedule| !schedule.is_serial());
        let pieces: BTreeSet<&str> = others.map(|schedule| schedule.key.decomposition.as_str()).collect();
        Ok(Serial {
            names_pieces: pieces.len() > 2,
            on_pieces: Partners::of(serial(), with_pieces)?,
            fastest: Partners::fastest(serial(), without_pieces),
            stopping: self.stopping(),
            usual_size: sizes.max_by_key(|(_, rows)| rows.len()).map(|(size, _)| size),
            schedules,
        })
    }
}

impl<'a> Serial<'a> {
    pub(super) fn others(&self) -> impl Iterator<Item = &'a Schedule> {
        self.schedules.keys().copied().filter(|schedule| !schedule.is_serial())
    }

    pub(super) fn rows(&self, schedule: &Schedule) -> &[&'a Row] {
        self.schedules.get(schedule).map_or(&[], Vec::as_slice)
    }

    /// Pairs each run of a schedule with the serial run on the same pieces.
    pub(super) fn pairs(&self, schedule: &Schedule) -> Pairs<'a> {
        self.on_pieces.pairs(self.rows(schedule).iter().copied())
    }

    /// Pairs each run that is not serial with the serial run on the same pieces, in the order of the rows.
    pub(super) fn in_order(&self, results: &'a Results) -> Pairs<'a> {
        self.on_pieces.pairs(results.rows().filter(|row| !row.schedule.is_serial()))
    }

    /// The gains of runs over `serial` for the same image in the same repetition.
    pub(super) fn gains(&self, rows: &[&'a Row], value: impl Fn(&Row) -> Option<f64>) -> Repeats {
        // Prefer the serial run on the same pieces: other pieces change at least the caches.
        let gains = self.on_pieces.pairs(rows.iter().copied()).gains(&value);
        if gains.is_empty() { self.fastest.pairs(rows.iter().copied()).gains(value) } else { gains }
    }

    /// The speedup of each schedule: the median of the ratios to `serial`.
    pub(super) fn speedups(&self) -> Vec<(&'a Schedule, Ratio)> {
        let own = |schedule| (schedule, self.gains(self.rows(schedule), |row| row.makespan_s));
        with_intervals(along(self.others().map(own), |schedule| self.line(schedule), self.stopping))
    }

    /// The speedups at numbers of workers that have a processor each, by line; in each line only those repetitions that
    /// all its points have.
    pub(super) fn lines(&self, processors: usize) -> BTreeMap<String, Line> {
        let own = self.others().filter(|schedule| schedule.key.threads <= processors).map(|schedule| {
            (self.line(schedule), (schedule.key.threads, self.pairs(schedule).gains(|row| row.makespan_s)))
        });
        gathered(own).into_iter().map(|(line, points)| (line, in_common(points))).collect()
    }

    /// CPU time of each schedule over that of `serial` on the same pieces in the same repetition: the median of the
    /// ratios. It shows how much more the same work costs on several processors, plus the cost of the schedule itself.
    pub(super) fn work_inflation(&self) -> BTreeMap<&'a Schedule, f64> {
        let own = self.others().map(|schedule| (schedule, self.pairs(schedule).costs(|row| row.cpu_s())));
        medians(own, self.stopping).into_iter().map(|(schedule, told)| (schedule, told.value)).collect()
    }

    /// A name for the schedules of a line: the strategy, with its pieces if there are several decompositions, and with
    /// the image size if most rows have another.
    pub(super) fn line(&self, schedule: &Schedule) -> String {
        let name = if self.names_pieces {
            format!("{}, {}", schedule.name, schedule.key.decomposition)
        } else {
            schedule.name.clone()
        };
        let own: BTreeSet<(u32, u32)> = self.rows(schedule).iter().map(|row| (row.width, row.height)).collect();
        match own.first().filter(|size| own.len() == 1 && Some(**size) != self.usual_size) {
            Some((width, height)) => format!("{name}, {width}x{height}"),
            None => name,
        }
    }
}
