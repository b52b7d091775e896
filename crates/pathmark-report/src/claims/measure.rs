//! Statistics of rows, with their intervals.

use super::condition::{Columns, Conditions, columns, number, text};
use super::statistic::{ForecastColumn, Kind};
use crate::analysis::fit::log_log;
use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mean::{Moments, geometric_interval, t_interval};
use crate::analysis::rank::spearman;
use crate::analysis::slope::power_law;
use crate::analysis::speedup::serial_fraction;
use crate::analysis::z_test::{critical_value, z_score};
use crate::contenders::{curves_of_seeds, one_per_seed};
use crate::error::InputError;
use crate::experiment::read_calibration;
use crate::measure::{image_columns, schedule_columns};
use crate::paired::ratios_by;
use crate::prelude::*;
use crate::simulate::{Contender, Hardware, contenders, forecast};
use std::collections::HashMap;

/// A value, its interval if there were enough values for one, and the number of values that the interval is computed from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Measurement {
    pub(super) value: f64,
    pub(super) interval: Option<Interval>,
    pub(super) count: usize,
}

impl Measurement {
    fn estimate(estimate: Option<Estimate>, count: usize) -> Option<Self> {
        let Estimate { value, interval } = estimate?;
        Some(Self { value, interval: Some(interval), count })
    }

    /// A counted value, which has no error.
    fn exact(value: f64, count: usize) -> Option<Self> {
        (count > 0).then(|| Self { value, interval: Interval::between(value, value, 1.0), count })
    }

    /// The median of some values. If they are too few for the level, `of_few` gives the interval; a single value has
    /// none.
    fn typical(
        values: &[f64],
        stopping: Stopping,
        level: f64,
        of_few: fn(&[f64], f64) -> Option<Estimate>,
    ) -> Option<Self> {
        let enough = stopping.median_interval(values, level).filter(|interval| interval.level >= level);
        let interval = enough.or_else(|| Some(of_few(values, level)?.interval));
        Some(Self { value: median(values)?, interval, count: values.len() })
    }
}

/// An experiment's rows with their columns.
pub(super) struct Evidence {
    results: Results,
    columns: Vec<Columns>,
}

type Pair<'a> = (&'a Row, &'a Columns);

/// Columns that may change with another one: rows that differ in it may differ in these, too.
const FOLLOWERS: [(&str, &[&str]); 5] = [
    ("scene", &["scene_hash", "effects", "accelerator", "max_depth", "roulette"]),
    ("estimator", &["max_depth", "roulette", "effects", "kernel_fallback"]),
    ("kernel", &["kernel_fallback", "simd", "effects", "accelerator"]),
    ("precision", &["simd", "accelerator"]),
    ("sampler", &["kernel", "kernel_fallback", "simd", "effects"]),
];

impl Evidence {
    pub(super) fn of(results: Results) -> Self {
        let columns = results.rows().map(|row| columns(row.as_written())).collect();
        Self { results, columns }
    }

    /// The rows that meet some conditions.
    pub(super) fn rows<'a>(&'a self, conditions: &'a Conditions) -> Vec<Pair<'a>> {
        self.results.rows().zip(&self.columns).filter(|(_, columns)| conditions.admit(columns)).collect()
    }

    /// The statistic of the rows that meet the conditions; `None` if there are no such rows, or too few to compute it.
    pub(super) fn measure(&self, conditions: &Conditions, kind: &Kind, level: f64) -> Result<Option<Measurement>> {
        let (rows, stopping) = (self.rows(conditions), self.results.stopping());
        let of = |column: &str| -> Vec<f64> { rows.iter().filter_map(|(_, row)| number(row, column)).collect() };
        let per = |above: &str, below: &str| -> Vec<f64> {
            let ratio =
                |row: &Columns| Some(number(row, above)? / number(row, below)?).filter(|ratio| ratio.is_finite());
            rows.iter().filter_map(|(_, row)| ratio(row)).collect()
        };
        Ok(match kind {
            Kind::Value { column, per: None } => Measurement::typical(&of(column), stopping, level, t_interval),
            Kind::Value { column, per: Some(below) } => {
                Measurement::typical(&per(column, below), stopping, level, t_interval)
            }
            Kind::Share { column, of } => share(&per(column, of), level),
            Kind::Count { column } => Measurement::exact(of(column).iter().sum(), of(column).len()),
            Kind::PairedRatio { column, over } => Measurement::typical(
                &self.ratios(&rows, conditions, over, column)?,
                stopping,
                level,
                geometric_interval,
            ),
            Kind::Speedup { over } => {
                let ratios = self.ratios(&rows, conditions, over, "makespan_s")?;
                let speedups: Vec<f64> = ratios.iter().map(|ratio| 1.0 / ratio).collect();
                Measurement::typical(&speedups, stopping, level, geometric_interval)
            }
            Kind::Exponent { x, y } => {
                let points = rows.iter().filter_map(|(_, row)| Some((number(row, x)?, number(row, y)?)));
                let points: Vec<(f64, f64)> = points.collect();
                Measurement::estimate(log_log(&points, level).map(|line| line.slope), points.len())
            }
            Kind::RmseSlope {} => {
                let own: Vec<&Row> = rows.iter().map(|(row, _)| *row).collect();
                let curves: Vec<_> = curves_of_seeds(&own).into_iter().map(|(curve, _)| curve).collect();
                let law = SeedCurves::of_errors(&curves).and_then(|curves| power_law(&curves, level));
                Measurement::estimate(law.map(|law| law.exponent), curves.len())
            }
            Kind::Z { column, over } => z(&rows, &self.rows(over), column, level),
            Kind::RankCorrelation { x, y, by } => rank_correlation(&rows, [x, y], by, level),
            Kind::Checksum {} => checksums(&rows),
            Kind::Forecast { strategy, cores, column } => self.forecast(&rows, (strategy, *cores), *column, level)?,
        })
    }

    /// Ratios of a column between rows and their partners in `over`. Partners may differ only in columns that the
    /// conditions name, and in those that change with them.
    fn ratios(&self, rows: &[Pair<'_>], own: &Conditions, over: &Conditions, column: &str) -> Result<Vec<f64>> {
        let named: BTreeSet<&str> = own.columns().chain(over.columns()).collect();
        let followers = FOLLOWERS.iter().filter(|(column, _)| named.contains(column)).flat_map(|(_, others)| *others);
        let free: BTreeSet<&str> = named.iter().copied().chain(followers.copied()).collect();
        let identity: Vec<&str> =
            image_columns().chain(schedule_columns()).filter(|column| !free.contains(column)).collect();
        let key = |row: &Row, columns: &Columns| {
            (identity.iter().map(|column| text(columns, column)).collect::<Vec<String>>(), row.repetition)
        };
        let of_two = |(row, _): Pair<'_>, (other, _): Pair<'_>| {
            let problem = format!("cannot be told from {} by the claim that compares with it", other.cell);
            InputError::new("cell", &row.cell, problem)
        };
        let keyed = |pair: &Pair<'_>| key(pair.0, pair.1);
        let (above, below) = (rows.iter().map(|pair| (keyed(pair), *pair)), self.rows(over));
        let below = below.into_iter().map(|pair| (keyed(&pair), pair));
        let ratios = ratios_by(above, below, of_two, |(_, columns)| number(columns, column))?;
        Ok(ratios.into_iter().filter(|ratio| ratio.is_finite() && *ratio > 0.0).collect())
    }

    /// The statistic of simulated schedules, from the traced jobs of serial rows. Its interval contains the differences
    /// between these runs and those between the calibrations of the folder.
    fn forecast(
        &self,
        rows: &[Pair<'_>],
        (strategy, cores): (&str, usize),
        column: ForecastColumn,
        level: f64,
    ) -> Result<Option<Measurement>> {
        let path = self.results.folder.join("calibration.csv");
        if !path.is_file() {
            return Ok(None);
        }
        let mut known = contenders(&self.results.definition.lab, &read_calibration(&path)?);
        known.push(Contender::longest_first());
        known.retain(|contender| contender.name == strategy);
        let mut traces = Vec::new();
        for (row, _) in rows.iter().filter(|(row, _)| row.schedule.is_serial()) {
            traces.extend(self.results.trace(row)?.map(|trace| trace.costs_s()));
        }
        let told = forecast(&traces, &known, &[cores], &Hardware::default(), level);
        let Some(told) = told.first() else { return Ok(None) };
        let value = match column {
            ForecastColumn::Speedup => Some(told.speedup),
            ForecastColumn::Efficiency => told.efficiency(),
            ForecastColumn::SerialFraction => told.speedup.through(|speedup| serial_fraction(speedup, cores)),
        };
        Ok(value.map(|told| Measurement { value: told.value, interval: told.interval, count: traces.len() }))
    }
}

/// The mean of some shares; if all are equal, that share exactly.
fn share(shares: &[f64], level: f64) -> Option<Measurement> {
    let first = *shares.first()?;
    if shares.len() > 1 && shares.iter().all(|share| *share == first) {
        return Measurement::exact(first, shares.len());
    }
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let interval = t_interval(shares, level).map(|estimate| estimate.interval);
    Some(Measurement { value: mean, interval, count: shares.len() })
}

/// The difference of two means over seeds in standard errors, plus or minus the normal quantile of the level.
fn z(rows: &[Pair<'_>], over: &[Pair<'_>], column: &str, level: f64) -> Option<Measurement> {
    let moments = |pairs: &[Pair<'_>]| {
        let own: Vec<&Row> = pairs.iter().map(|(row, _)| *row).collect();
        let by_row: HashMap<*const Row, f64> = pairs
            .iter()
            .filter_map(|(row, columns)| Some((std::ptr::from_ref(*row), number(columns, column)?)))
            .collect();
        Moments::of(&one_per_seed(&own, |row| by_row.get(&std::ptr::from_ref(row)).copied()))
    };
    let (a, b) = (moments(rows), moments(over));
    let score = z_score(a.mean()?, a.standard_error()?, b.mean()?, b.standard_error()?)?;
    let interval = Interval::around(score, critical_value(1.0 - level)?, level);
    Some(Measurement { value: score, interval, count: (a.count() + b.count()) as usize })
}

/// Spearman's coefficient over the means of groups, with Fisher's interval. The variance for ranks is from E. C.
/// Fieller, H. O. Hartley and E. S. Pearson, "Tests for rank correlation coefficients", Biometrika 44 (1957).
fn rank_correlation(rows: &[Pair<'_>], [x, y]: [&str; 2], by: &str, level: f64) -> Option<Measurement> {
    let mut groups: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for (_, row) in rows {
        if let Some(pair) = number(row, x).zip(number(row, y)) {
            groups.entry(text(row, by)).or_default().push(pair);
        }
    }
    let mean = |pairs: &Vec<(f64, f64)>| {
        let (a, b) = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        (a / pairs.len() as f64, b / pairs.len() as f64)
    };
    let points: Vec<(f64, f64)> = groups.values().map(mean).collect();
    let rho = spearman(&points)?.rho;
    let spread = (points.len() > 3).then(|| (1.06 / (points.len() as f64 - 3.0)).sqrt())?;
    let half = spread * critical_value(1.0 - level)?;
    // A perfect order has an infinite transform, so rho is clamped.
    let centre = libm::atanh(rho.clamp(-0.999_999, 0.999_999));
    let interval = Interval::between(libm::tanh(centre - half), libm::tanh(centre + half), level);
    Some(Measurement { value: rho, interval, count: points.len() })
}

/// The largest number of different checksums of one image; `None` if no image has two rows.
fn checksums(rows: &[Pair<'_>]) -> Option<Measurement> {
    let mut images: BTreeMap<_, Vec<&str>> = BTreeMap::new();
    // A sampler that draws other random numbers in each run leaves no checksum.
    for (row, _) in rows.iter().filter(|(row, _)| !row.checksum.is_empty()) {
        images.entry(&row.image).or_default().push(&row.checksum);
    }
    let compared: Vec<&Vec<&str>> = images.values().filter(|checksums| checksums.len() > 1).collect();
    let most = compared.iter().map(|sums| sums.iter().collect::<BTreeSet<_>>().len()).max()?;
    Measurement::exact(most as f64, compared.iter().map(|sums| sums.len()).sum())
}
