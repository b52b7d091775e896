//! Statistics of rows, with their intervals.

use super::condition::{Columns, Conditions, columns, number, text};
use super::measurement::{Measurement, Rule, Scale};
use super::statistic::{ForecastColumn, Kind, Unit};
use crate::analysis::fit::log_log;
use crate::analysis::jackknife::SeedCurves;
use crate::analysis::mean::mean_ratio;
use crate::analysis::rank::spearman;
use crate::analysis::ranking::Turn;
use crate::analysis::slope::power_law;
use crate::analysis::speedup::serial_fraction;
use crate::analysis::z_test::critical_value;
use crate::contenders::{curves_of_seeds, one_per_seed};
use crate::error::InputError;
use crate::experiment::read_calibration;
use crate::measure::{image_columns, schedule_columns};
use crate::paired::ratios_by;
use crate::prelude::*;
use crate::simulate::{Contender, Hardware, contenders, forecast};
use std::collections::HashMap;

/// An experiment's rows in one folder with their columns: all runs of each process.
pub(super) struct Evidence {
    /// `None` for a table of another program.
    results: Option<Results>,
    /// The rows of another program.
    table: Vec<Row>,
    columns: Vec<Columns>,
    /// The columns of another program's table that say what ran.
    settings: Vec<String>,
}

/// A row of a folder, by the folder's place among those that are measured together.
#[derive(Clone, Copy)]
pub(super) struct Item<'a> {
    run: usize,
    row: &'a Row,
    pub(super) columns: &'a Columns,
}

/// The question of a claim to rows.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub(super) rows: &'a Conditions,
    /// Conditions that the rows have to meet, too.
    pub(super) also: Option<&'a Conditions>,
    pub(super) kind: &'a Kind,
    pub(super) unit: Unit,
    pub(super) level: f64,
}

/// With so many runs, the runs are the independent units: then the extremes of their medians enclose the typical value.
const ENOUGH_RUNS: usize = 6;

/// An independent unit. Images do not depend on the run, so seeds and scenes of several runs are the same units.
type Key = (Option<usize>, String);

/// Columns that may change with another one: rows that differ in it may differ in these, too.
const FOLLOWERS: [(&str, &[&str]); 5] = [
    ("scene", &["scene_hash", "effects", "accelerator", "max_depth", "roulette"]),
    ("estimator", &["max_depth", "roulette", "effects", "kernel_fallback"]),
    ("kernel", &["kernel_fallback", "simd", "effects", "accelerator"]),
    ("precision", &["simd", "accelerator"]),
    ("sampler", &["kernel", "kernel_fallback", "simd", "effects"]),
];

impl Unit {
    fn key(self, item: Item<'_>) -> Key {
        let Item { run, row, .. } = item;
        match self {
            Self::Repetition => (Some(run), format!("{:06} {:06}", row.seed, row.repetition)),
            Self::Seed => (None, row.seed.to_string()),
            Self::Scene => (None, row.scene.clone()),
        }
    }

    fn noun(self) -> &'static str {
        match self {
            Self::Repetition => "repetition",
            Self::Seed => "seed",
            Self::Scene => "scene",
        }
    }
}

impl Evidence {
    pub(super) fn of(results: Results) -> Self {
        let columns = results.rows().flat_map(Row::runs).map(|row| columns(row.as_written())).collect();
        Self { results: Some(results), table: Vec::new(), columns, settings: Vec::new() }
    }

    /// Rows of another program, with the columns that say what ran.
    pub(super) fn of_table((table, columns): (Vec<Row>, Vec<Columns>), settings: &[String]) -> Self {
        Self { results: None, table, columns, settings: settings.to_vec() }
    }

    fn items(&self, run: usize) -> impl Iterator<Item = Item<'_>> {
        let rows = self.results.iter().flat_map(Results::rows).flat_map(Row::runs).chain(&self.table);
        rows.zip(&self.columns).map(move |(row, columns)| Item { run, row, columns })
    }

    /// The columns of all rows.
    pub(super) fn columns(&self) -> &[Columns] {
        &self.columns
    }

    /// The rows that meet some conditions.
    pub(super) fn rows<'a>(&'a self, conditions: &'a Conditions) -> impl Iterator<Item = Item<'a>> {
        self.items(0).filter(|item| conditions.admit(item.columns))
    }

    /// The statistic of simulated schedules, from the traced jobs of serial rows. Its interval contains the differences
    /// between these runs and those between the calibrations of the folder.
    fn forecast(
        &self,
        rows: &[&Row],
        (strategy, cores): (&str, usize),
        column: ForecastColumn,
        level: f64,
    ) -> Result<Option<Measurement>> {
        let Some(results) = &self.results else { return Ok(None) };
        let path = results.calibration_path();
        if !path.is_file() {
            return Ok(None);
        }
        let mut known = contenders(&results.definition.lab, &read_calibration(&path)?);
        known.push(Contender::longest_first());
        known.retain(|contender| contender.name == strategy);
        let mut traces = Vec::new();
        for row in rows.iter().filter(|row| row.schedule.is_serial()) {
            traces.extend(results.trace(row)?.map(|trace| trace.costs_s()));
        }
        let told = forecast(&traces, &known, &[cores], &Hardware::default(), level);
        let Some(told) = told.first() else { return Ok(None) };
        let value = match column {
            ForecastColumn::Speedup => Some(told.speedup),
            ForecastColumn::Efficiency => told.efficiency(),
            ForecastColumn::SerialFraction => told.speedup.through(|speedup| serial_fraction(speedup, cores)),
        };
        Ok(value.map(|told| Measurement::of_table(told.value, told.interval, traces.len(), "trace")))
    }
}

impl Item<'_> {
    pub(super) fn started_utc(&self) -> &str {
        &self.row.started_utc
    }
}

/// Rows of one or several runs of an experiment.
struct Rows<'a> {
    runs: &'a [&'a Evidence],
    query: Query<'a>,
    own: Vec<Item<'a>>,
    stopping: Stopping,
}

/// The statistic of the rows of some runs together; `None` if there are no such rows, or too few to compute it.
pub(super) fn measure(runs: &[&Evidence], query: Query<'_>) -> Result<Option<Measurement>> {
    let mut results = runs.iter().filter_map(|run| run.results.as_ref());
    let is_sequential = results.any(|results| results.stopping() == Stopping::Sequential);
    let stopping = if is_sequential { Stopping::Sequential } else { Stopping::Fixed };
    let own = items(runs).filter(|item| query.admits(item.columns)).collect();
    Rows { runs, query, own, stopping }.measure()
}

fn items<'a>(runs: &'a [&'a Evidence]) -> impl Iterator<Item = Item<'a>> {
    runs.iter().enumerate().flat_map(|(run, evidence)| evidence.items(run))
}

impl Query<'_> {
    pub(super) fn admits(&self, row: &Columns) -> bool {
        self.rows.admit(row) && self.also.is_none_or(|also| also.admit(row))
    }
}

impl<'a> Rows<'a> {
    fn measure(&self) -> Result<Option<Measurement>> {
        let Query { kind, level, .. } = self.query;
        let own = &self.own;
        let found = match kind {
            Kind::Value { column, plus, per } => {
                let value = |item: &Item<'_>| {
                    let more = plus.as_ref().map_or(Some(0.0), |plus| number(item.columns, plus));
                    let sum = number(item.columns, column)? + more?;
                    let below = per.as_ref().map_or(Some(1.0), |per| number(item.columns, per))?;
                    Some(sum / below).filter(|value| value.is_finite())
                };
                self.typical(own.iter().filter_map(|item| Some((*item, value(item)?))), Scale::Linear, false)
            }
            Kind::Count { column } => {
                let counts: Vec<f64> = own.iter().filter_map(|item| number(item.columns, column)).collect();
                Measurement::exact(counts.iter().sum(), counts.len(), "row")
            }
            Kind::PairedRatio { column, over } => {
                let (ratios, are_of_pairs) = self.ratios(over, column)?;
                self.typical(ratios, Scale::Logarithmic, are_of_pairs)
            }
            Kind::Speedup { over, column } => {
                let column = column.as_ref().map_or("makespan_s", |column| column);
                let (ratios, are_of_pairs) = self.ratios(over, column)?;
                let speedups = ratios.into_iter().map(|(item, ratio)| (item, 1.0 / ratio));
                self.typical(speedups, Scale::Logarithmic, are_of_pairs)
            }
            Kind::Exponent { x, y } => self.exponent(x, y),
            Kind::RmseSlope {} => {
                let own: Vec<&Row> = own.iter().map(|item| item.row).collect();
                let curves: Vec<_> = curves_of_seeds(&own).into_iter().map(|(curve, _)| curve).collect();
                let law = SeedCurves::of_errors(&curves).and_then(|curves| power_law(&curves, level));
                Measurement::estimate(law.map(|law| law.exponent), Rule::Jackknife, curves.len(), "seed")
            }
            Kind::MeanRatio { column, over } => {
                let over: Vec<Item<'_>> = items(self.runs).filter(|item| over.admit(item.columns)).collect();
                let [above, below] = [own, &over].map(|items| per_seed(items, column));
                // More units on one side alone make no ratio sure, so the smaller number counts.
                let (units, others) = (above.len().min(below.len()), above.len().max(below.len()));
                let rule = Rule::Welch { others };
                Measurement::estimate(mean_ratio(&above, &below, level), rule, units, Unit::Seed.noun())
            }
            Kind::RankCorrelation { x, y, by } => rank_correlation(own, [x, y], by, level),
            Kind::Checksum {} => checksums(own),
            Kind::Forecast { strategy, cores, column } => {
                let of_run = |(run, evidence): (usize, &&Evidence)| {
                    let rows: Vec<&Row> = own.iter().filter(|item| item.run == run).map(|item| item.row).collect();
                    evidence.forecast(&rows, (strategy, *cores), *column, level).transpose()
                };
                let found = self.runs.iter().enumerate().filter_map(of_run).collect::<Result<Vec<_>>>()?;
                if let [one] = found.as_slice() { Some(*one) } else { Measurement::hull(&found) }
            }
        };
        Ok(found)
    }

    /// The typical value of units: each has the mean over its cells of the median of the cell's pairs. Ratios of adjacent pairs
    /// have the rule of figures and tables.
    fn typical(
        &self,
        values: impl IntoIterator<Item = (Item<'a>, f64)>,
        scale: Scale,
        are_of_pairs: bool,
    ) -> Option<Measurement> {
        let Query { unit, level, .. } = self.query;
        let mut units: BTreeMap<Key, BTreeMap<(usize, &str), Vec<f64>>> = BTreeMap::new();
        for (item, value) in values {
            let cell = (if unit == Unit::Repetition { item.run } else { 0 }, item.row.cell.as_str());
            units.entry(unit.key(item)).or_default().entry(cell).or_default().push(value);
        }
        let of_unit = |cells: &BTreeMap<_, Vec<f64>>| {
            scale.mean(&cells.values().filter_map(|values| median(values)).collect::<Vec<f64>>())
        };
        let mut runs: BTreeMap<Option<usize>, Vec<f64>> = BTreeMap::new();
        for ((run, _), cells) in &units {
            runs.entry(*run).or_default().extend(of_unit(cells));
        }
        if runs.len() >= ENOUGH_RUNS {
            let values: Vec<f64> = runs.values().filter_map(|values| scale.mean(values)).collect();
            return Measurement::typical(&values, scale, self.stopping, level, "run");
        }
        let values: Vec<f64> = runs.into_values().flatten().collect();
        let of_pairs = are_of_pairs && unit == Unit::Repetition && self.stopping == Stopping::Fixed;
        let of_pairs = of_pairs.then(|| Measurement::of_pairs(&values, level, unit.noun())).flatten();
        of_pairs.or_else(|| Measurement::typical(&values, scale, self.stopping, level, unit.noun()))
    }

    /// Ratios of a column between rows and their partners in `over`, in the same run and the same pair of one process; if no
    /// rows are of pairs, or those of other cells, in the same repetition. Partners may differ only in columns that the
    /// conditions name, and in those that change with them. Also returns whether the ratios are of adjacent pairs.
    fn ratios(&self, over: &Conditions, column: &str) -> Result<(Vec<(Item<'a>, f64)>, bool)> {
        let settings = self.runs.first().map_or(&[][..], |run| &run.settings);
        let identity = identity(self.query.rows, over, settings);
        let key = |item: &Item<'_>, turn: Turn| {
            (item.run, identity.iter().map(|column| text(item.columns, column)).collect::<Vec<String>>(), turn)
        };
        let of_two = |(item, _): (Item<'_>, f64), (other, _): (Item<'_>, f64)| {
            let problem = format!("cannot be told from {} by the claim that compares with it", other.row.cell);
            InputError::new("cell", &item.row.cell, problem)
        };
        let below: Vec<Item<'_>> = items(self.runs).filter(|item| over.admit(item.columns)).collect();
        let (mut found, mut are_of_pairs) = (Vec::new(), false);
        for keeps_pairs in [true, false] {
            let [above, below] = [&self.own, &below].map(|items| {
                let values = per_turn(items, column, keeps_pairs).into_iter();
                values.map(|(turn, item, value)| (key(&item, turn), (item, value))).collect::<Vec<_>>()
            });
            found = ratios_by(above, below, of_two, |(_, value)| Some(value))?;
            if !found.is_empty() {
                are_of_pairs = keeps_pairs && found.iter().any(|((item, _), _)| item.row.pair.is_some());
                break;
            }
        }
        let ratios = found.into_iter().map(|((item, _), ratio)| (item, ratio));
        Ok((ratios.filter(|(_, ratio)| ratio.is_finite() && *ratio > 0.0).collect(), are_of_pairs))
    }

    /// The exponent of y against x: of a line through all processes, each a point; for units other than repetitions the
    /// typical exponent of the units' own lines.
    fn exponent(&self, x: &str, y: &str) -> Option<Measurement> {
        let Query { unit, level, .. } = self.query;
        let xs: HashMap<*const Columns, f64> = (self.own.iter())
            .filter_map(|item| Some((std::ptr::from_ref(item.columns), number(item.columns, x)?)))
            .collect();
        let points = per_turn(&self.own, y, false).into_iter();
        let points = points.filter_map(|(_, item, y)| Some((item, *xs.get(&std::ptr::from_ref(item.columns))?, y)));
        let points: Vec<(Item<'_>, f64, f64)> = points.filter(|(_, x, y)| *x > 0.0 && *y > 0.0).collect();
        if unit == Unit::Repetition {
            let points: Vec<(f64, f64)> = points.iter().map(|(_, x, y)| (*x, *y)).collect();
            let line = log_log(&points, level).map(|line| line.slope);
            return Measurement::estimate(line, Rule::Line, points.len(), "point");
        }
        let lines = gathered(points.iter().map(|(item, x, y)| (unit.key(*item), (*x, *y))));
        let slopes = lines.values().filter_map(|points| Some(log_log(points, level)?.slope.value));
        Measurement::typical(&slopes.collect::<Vec<f64>>(), Scale::Linear, self.stopping, level, unit.noun())
    }
}

/// The columns that partners share: those of image and schedule, or the `settings` of another program's table, that the
/// conditions leave alone.
pub(super) fn identity<'a>(rows: &Conditions, over: &Conditions, settings: &'a [String]) -> Vec<&'a str> {
    let named: BTreeSet<&str> = rows.columns().chain(over.columns()).collect();
    let followers = FOLLOWERS.iter().filter(|(column, _)| named.contains(column)).flat_map(|(_, others)| *others);
    let free: BTreeSet<&str> = named.iter().copied().chain(followers.copied()).collect();
    let known = image_columns().chain(schedule_columns()).map(|column| -> &'a str { column });
    let own = known.chain(settings.iter().map(String::as_str));
    own.filter(|column| !free.contains(column)).collect()
}

/// A run, a cell and a turn.
type Place<'a> = (usize, &'a str, Turn);

type Valued<'a> = (Item<'a>, f64);

/// The values of rows by repetition and pair, or the median of each cell's pairs by repetition, with one of their rows.
fn per_turn<'a>(items: &[Item<'a>], column: &str, keeps_pairs: bool) -> Vec<(Turn, Item<'a>, f64)> {
    let place = |item: &Item<'a>| {
        let Item { run, row, .. } = *item;
        (run, row.cell.as_str(), (row.turn.0, row.turn.1.filter(|_| keeps_pairs)))
    };
    let valued = items.iter().filter_map(|item| Some((place(item), (*item, number(item.columns, column)?))));
    let of_turn = |((_, _, turn), all): (Place<'_>, Vec<Valued<'a>>)| {
        Some((turn, all.first()?.0, median(&all.iter().map(|(_, value)| *value).collect::<Vec<f64>>())?))
    };
    gathered(valued).into_iter().filter_map(of_turn).collect()
}

/// The mean of a column over the images of each seed.
fn per_seed(items: &[Item<'_>], column: &str) -> Vec<f64> {
    let own: Vec<&Row> = items.iter().map(|item| item.row).collect();
    let by_row: HashMap<*const Row, f64> =
        items.iter().filter_map(|item| Some((std::ptr::from_ref(item.row), number(item.columns, column)?))).collect();
    one_per_seed(&own, |row| by_row.get(&std::ptr::from_ref(row)).copied())
}

/// Spearman's coefficient over the means of groups, with Fisher's interval. The variance for ranks is from E. C.
/// Fieller, H. O. Hartley and E. S. Pearson, "Tests for rank correlation coefficients", Biometrika 44 (1957).
fn rank_correlation(items: &[Item<'_>], [x, y]: [&str; 2], by: &str, level: f64) -> Option<Measurement> {
    let mut groups: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for Item { columns, .. } in items {
        if let Some(pair) = number(columns, x).zip(number(columns, y)) {
            groups.entry(text(columns, by)).or_default().push(pair);
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
    let estimate = interval.map(|interval| Estimate { value: rho, interval });
    Measurement::estimate(estimate, Rule::Ranks, points.len(), if by == "scene" { "scene" } else { "group" })
}

/// The largest number of different checksums of one image; `None` if no image has two rows.
fn checksums(items: &[Item<'_>]) -> Option<Measurement> {
    let mut images: BTreeMap<_, Vec<&str>> = BTreeMap::new();
    // A sampler that draws other random numbers in each run leaves no checksum. Runs of two revisions may differ.
    for Item { run, row, .. } in items.iter().filter(|item| !item.row.checksum.is_empty()) {
        images.entry((*run, &row.image)).or_default().push(&row.checksum);
    }
    let compared: Vec<&Vec<&str>> = images.values().filter(|checksums| checksums.len() > 1).collect();
    let most = compared.iter().map(|sums| sums.iter().collect::<BTreeSet<_>>().len()).max()?;
    Measurement::exact(most as f64, compared.len(), "image")
}
