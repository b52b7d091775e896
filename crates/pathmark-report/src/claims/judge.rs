//! The judgement of claims by the results in some folders.
//!
//! Each folder is a run. Rows of all runs at the report's own size are measured together, and each run alone: a verdict stands only if
//! every run alone has it, too. A run of one or two units is not judged alone. Folders are read in the order of their paths, so the order in which they are named changes nothing.

use super::absent::{check_values, lacking_file, why};
use super::condition::{Columns, Conditions};
use super::definition::{Claim, Report, Test};
use super::measure::{Evidence, Item, Query, measure};
use super::measurement::Measurement;
use super::places::Part as Place;
use super::statistic::{Cases, GuardColumn, GuardValue, Kind, Statistic};
use super::verdict::Verdict;
use crate::cases_file::{self, CaseRow};
use crate::error::InputError;
use crate::experiment::{MACHINE, has_records, read_run_file, records_path};
use crate::guard_prices::{self, PriceRow, read_prices};
use crate::lab::Lab;
use crate::prelude::*;
use crate::time::is_time;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug)]
pub struct Answer<'a> {
    pub report: &'a Report,
    pub claim: &'a Claim,
    pub verdict: Verdict,
    /// The reason for the verdict, beyond the measured values.
    pub why: String,
    /// The files that the values come from.
    pub sources: Vec<PathBuf>,
    pub(super) found: Option<Measurement>,
    /// The verdicts of the runs alone; none for a run that is too short for one.
    pub(super) runs: Vec<Option<Verdict>>,
    /// How many more units would settle an open claim; if runs differ, in each run.
    pub(super) to_settle: Option<usize>,
    pub(super) age: Age,
    /// The table whose file no folder has.
    pub(super) lacks: Option<InputError>,
}

/// Whether the claim was fixed before its rows were measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Age {
    /// Before the first of them.
    BoundFirst,
    /// After at least one of them: its bound may have been chosen by them.
    RowsFirst,
    /// The rows do not tell their time.
    Unknown,
}

impl Answer<'_> {
    /// Whether the verdict differs from those expected of a run at the report's own size. A verdict without comparable
    /// rows is never unexpected.
    pub fn is_unexpected(&self) -> bool {
        self.is_judged() && !self.claim.expected_verdicts().any(|name| name == self.verdict.name())
    }

    /// Whether rows judge the claim that are not known to be younger than its bound.
    pub fn is_bound_younger(&self) -> bool {
        self.is_judged() && self.found.is_some() && self.age != Age::BoundFirst
    }

    /// Whether no rows answer a claim of a user's ledger, although a verdict was expected.
    pub fn is_unanswered(&self) -> bool {
        self.report.is_own() && self.verdict == Verdict::NotAnswered && !self.may_be_unanswered()
    }

    pub(super) fn may_be_unanswered(&self) -> bool {
        self.claim.expected_verdicts().any(|name| name == Verdict::NotAnswered.name())
    }

    /// Whether the claim is about simulated schedules, which need calibrations and traces beside the rows.
    pub(crate) fn is_of_forecast(&self) -> bool {
        let statistic = self.claim.test().map(|test| &test.statistic);
        matches!(statistic, Ok(Statistic::OfRows { kind: Kind::Forecast { .. }, .. }))
    }

    pub(super) fn is_judged(&self) -> bool {
        !matches!(self.verdict, Verdict::NotAnswered | Verdict::NotComparable | Verdict::Measured)
    }
}

/// The results of a folder, read once for all claims.
struct Library<'a> {
    lab: &'a Arc<Lab>,
    out: &'a Path,
    /// By experiment, or by report and table.
    experiments: BTreeMap<(String, String), Option<Evidence>>,
    cases: Vec<CaseRow>,
    prices: Vec<PriceRow>,
}

/// The part of a folder that answers a claim.
struct Part<'a> {
    source: PathBuf,
    /// The measured value of this folder alone.
    alone: Measurement,
    /// The rows, if they can be measured together with those of other folders.
    rows: Option<&'a Evidence>,
    /// The conditions that differ from the report's; empty if the rows are comparable.
    differences: Vec<String>,
    /// The time at which the first row was measured, if all tell it.
    started_utc: Option<String>,
}

/// Judges every claim by the results in some folders.
pub fn judge<'a>(lab: &Arc<Lab>, reports: &'a [Report], folders: &[PathBuf]) -> Result<Vec<Answer<'a>>> {
    // A folder that is named twice is one run.
    let own_path = |folder: &PathBuf| folder.canonicalize().unwrap_or_else(|_| folder.clone());
    let folders: BTreeMap<PathBuf, &PathBuf> = folders.iter().map(|folder| (own_path(folder), folder)).collect();
    let mut libraries = folders.values().map(|out| Library::open(lab, out)).collect::<Result<Vec<_>>>()?;
    let claims = reports.iter().flat_map(|report| report.claims.iter().enumerate().map(move |own| (report, own)));
    let mut answers = Vec::new();
    for (report, (index, claim)) in claims {
        let without = |verdict, why: &str| {
            let (why, sources, runs) = (why.to_string(), Vec::new(), Vec::new());
            let (found, to_settle, age, lacks) = (None, None, Age::Unknown, None);
            Answer { report, claim, verdict, why, sources, found, runs, to_settle, age, lacks }
        };
        let test = match claim.test() {
            Err((verdict, why)) => {
                answers.push(without(verdict, why));
                continue;
            }
            Ok(test) => test,
        };
        if let Statistic::OfRows { experiment, .. } = &test.statistic {
            for library in &mut libraries {
                library.load(report, experiment)?;
            }
        }
        let evidence: Vec<&Evidence> = libraries.iter().filter_map(|library| library.evidence(report, test)).collect();
        check_values(report, index, &test.statistic, &evidence)?;
        let parts = libraries
            .iter()
            .filter_map(|library| library.part(report, test).transpose())
            .collect::<Result<Vec<_>>>()?;
        if parts.is_empty() {
            let lacks = lacking_file(report, &test.statistic, &evidence);
            let why = why(report, &test.statistic, &evidence);
            answers.push(Answer { lacks, ..without(Verdict::NotAnswered, &why) });
            continue;
        }
        let is_comparable = parts.iter().any(|part| part.differences.is_empty());
        let parts: Vec<Part<'_>> =
            parts.into_iter().filter(|part| part.differences.is_empty() == is_comparable).collect();
        answers.push(verdict_of(&parts, without(Verdict::NotComparable, ""), test)?);
    }
    answers.sort_by_key(|answer| answer.claim.id);
    Ok(answers)
}

/// The answer of some runs: all at the report's own size, or none of them.
fn verdict_of<'a>(parts: &[Part<'_>], blank: Answer<'a>, test: &Test) -> Result<Answer<'a>> {
    let evidence: Option<Vec<&Evidence>> = parts.iter().map(|part| part.rows).collect();
    let together = match (evidence, parts, &test.statistic) {
        (Some(evidence), [_, _, ..], Statistic::OfRows { .. }) => {
            query(test, parts[0].differences.is_empty()).map_or(Ok(None), |query| measure(&evidence, query))?
        }
        (_, [one], _) => Some(one.alone),
        _ => Measurement::hull(&parts.iter().map(|part| part.alone).collect::<Vec<_>>()),
    };
    let Some(found) = together else { return Ok(blank) };
    let mut differences: Vec<&str> = Vec::new();
    for difference in parts.iter().flat_map(|part| &part.differences) {
        if !differences.contains(&difference.as_str()) {
            differences.push(difference);
        }
    }
    let sources = parts.iter().map(|part| part.source.clone()).collect();
    let why = differences.join("; ");
    let Some(predicted) = test.predicted else {
        let is_comparable = differences.is_empty();
        let verdict = if is_comparable { Verdict::Measured } else { Verdict::NotComparable };
        return Ok(Answer { verdict, why, sources, found: Some(found), ..blank });
    };
    let alone = |part: &Part<'_>| part.alone.stands_alone().then(|| Verdict::of(&part.alone, predicted));
    let runs: Vec<Option<Verdict>> = parts.iter().map(alone).collect();
    let all = Verdict::of(&found, predicted);
    let agree = runs.iter().flatten().all(|run| *run == all);
    let verdict = match all {
        _ if !differences.is_empty() && !test.a_fortiori => Verdict::NotComparable,
        all if agree => all,
        _ => Verdict::Open,
    };
    let needed = |found: &Measurement| found.units_to_settle(predicted, test.level);
    let of_runs = || parts.iter().filter(|part| alone(part) == Some(Verdict::Open));
    let to_settle = match verdict {
        Verdict::Open if agree => needed(&found),
        Verdict::Open => {
            of_runs().map(|part| needed(&part.alone)).collect::<Option<Vec<_>>>().and_then(|all| all.into_iter().max())
        }
        _ => None,
    };
    let started: Option<Vec<&String>> = parts.iter().map(|part| part.started_utc.as_ref()).collect();
    let age = match started.and_then(|started| started.into_iter().min()) {
        None => Age::Unknown,
        Some(first) if first.as_str() < blank.claim.frozen_utc() => Age::RowsFirst,
        Some(_) => Age::BoundFirst,
    };
    Ok(Answer { verdict, why, sources, found: Some(found), runs, to_settle, age, ..blank })
}

/// The question of a test to rows: to those at the report's own size, or to all.
fn query(test: &Test, is_comparable: bool) -> Option<Query<'_>> {
    let Statistic::OfRows { rows, unit, kind, .. } = &test.statistic else { return None };
    let also = Some(&test.comparable_if).filter(|_| is_comparable);
    Some(Query { rows, also, kind, unit: *unit, level: test.level })
}

impl<'a> Library<'a> {
    fn open(lab: &'a Arc<Lab>, out: &'a Path) -> Result<Self> {
        let prices = out.join(guard_prices::FOLDER).join(guard_prices::FILE);
        Ok(Self {
            lab,
            out,
            experiments: BTreeMap::new(),
            cases: cases_file::read(out)?,
            prices: if prices.is_file() { read_prices(&prices)? } else { Vec::new() },
        })
    }

    /// Reads an experiment or a table of the report's ledger, if the folder has it.
    fn load(&mut self, report: &Report, name: &str) -> Result<()> {
        let key = key(report, name);
        if self.experiments.contains_key(&key) {
            return Ok(());
        }
        let table = report.tables.iter().enumerate().find(|(_, table)| table.name == name);
        let evidence = if let Some((index, table)) = table {
            let rows = table.read(self.out).map_err(|error| report.located(Place::Table(index), error))?;
            rows.map(|rows| Evidence::of_table(rows, &table.settings))
        } else {
            let folder = self.out.join(name);
            let has_rows = has_records(&folder);
            has_rows.then(|| Results::read(self.lab, self.out, &folder)).transpose()?.map(Evidence::of)
        };
        self.experiments.insert(key, evidence);
        Ok(())
    }

    /// The rows of the experiment or table that a test asks for.
    fn evidence(&self, report: &Report, test: &Test) -> Option<&Evidence> {
        let Statistic::OfRows { experiment, .. } = &test.statistic else { return None };
        self.experiments.get(&key(report, experiment))?.as_ref()
    }

    /// The part that answers a claim; `None` if there is none.
    fn part(&self, report: &Report, test: &Test) -> Result<Option<Part<'_>>> {
        let of_table = |found: Option<Measurement>, folder: &str, file: &str| {
            let folder = self.out.join(folder);
            found.map(|alone| Part {
                source: folder.join(file),
                alone,
                rows: None,
                differences: Vec::new(),
                started_utc: started(&folder),
            })
        };
        match &test.statistic {
            Statistic::OfRows { experiment, rows, .. } => {
                let Some(evidence) = self.evidence(report, test) else { return Ok(None) };
                let of_table = report.table(experiment).map(|table| table.path(self.out));
                let source = of_table.unwrap_or_else(|| records_path(&self.out.join(experiment)));
                part_of_rows(evidence, source, rows, test)
            }
            Statistic::Case(Cases { ids }) => {
                Ok(of_table(self.failed_cases(ids), cases_file::FOLDER, cases_file::FILE))
            }
            Statistic::Guard(GuardValue { guard, column }) => {
                Ok(of_table(self.price(guard, *column), guard_prices::FOLDER, guard_prices::FILE))
            }
        }
    }

    /// The number of these hard cases that failed, if all of them were tried.
    fn failed_cases(&self, ids: &[String]) -> Option<Measurement> {
        let tried = ids.iter().map(|id| self.cases.iter().find(|case| case.id == *id && case.trials > 0));
        let tried = tried.collect::<Option<Vec<&CaseRow>>>()?;
        let failed = tried.iter().filter(|case| !case.pass).count() as f64;
        Measurement::exact(failed, tried.len(), "case")
    }

    fn price(&self, guard: &str, column: GuardColumn) -> Option<Measurement> {
        let row = self.prices.iter().find(|row| row.guard == guard)?;
        let (value, low, high) = match column {
            GuardColumn::ErrorWith => (row.error_with, row.error_with_low, row.error_with_high),
            GuardColumn::ErrorWithout => (row.error_without, row.error_without_low, row.error_without_high),
            GuardColumn::TimeRatio => (row.time_ratio?, row.time_ratio_low?, row.time_ratio_high?),
        };
        Some(Measurement::of_table(value, Interval::between(low, high, guard_prices::LEVEL), 1, "price list"))
    }
}

/// The rows at the report's own size, or else all rows with the conditions in which they differ.
fn part_of_rows<'a>(
    evidence: &'a Evidence,
    source: PathBuf,
    rows: &Conditions,
    test: &Test,
) -> Result<Option<Part<'a>>> {
    for is_comparable in [true, false] {
        let Some(query) = query(test, is_comparable) else { break };
        let Some(alone) = measure(&[evidence], query)? else { continue };
        let own: Vec<_> = evidence.rows(rows).filter(|item| query.admits(item.columns)).collect();
        let columns: Vec<&Columns> = own.iter().map(|item| item.columns).collect();
        let started: Vec<&str> = own.iter().map(Item::started_utc).collect();
        let first = started.iter().min().filter(|_| started.iter().all(|own| is_time(own)));
        return Ok(Some(Part {
            source,
            alone,
            rows: Some(evidence),
            differences: differences(&test.comparable_if, &columns),
            started_utc: first.map(ToString::to_string),
        }));
    }
    Ok(None)
}

/// The place of an experiment's rows, or of a table of the report's ledger.
fn key(report: &Report, name: &str) -> (String, String) {
    let ledger = report.table(name).map_or_else(String::new, |_| report.report.clone());
    (ledger, name.to_string())
}

/// The time at which the measurement of a folder began, if its file tells it.
fn started(folder: &Path) -> Option<String> {
    Some(read_run_file(&folder.join(MACHINE)).ok()?.started_utc).filter(|started| is_time(started))
}

/// The differences between the rows' conditions and the required ones, each once; if the size differs, also the ratio
/// of pixels.
fn differences(wanted: &Conditions, rows: &[&Columns]) -> Vec<String> {
    let missed: BTreeSet<(String, String, String)> = rows.iter().flat_map(|row| wanted.differences(row)).collect();
    let mut told: Vec<String> =
        missed.iter().map(|(column, own, wanted)| format!("{column} = {own} instead of {wanted}")).collect();
    let factor = |name: &str| {
        let of = missed.iter().find(|(column, ..)| column == name);
        of.map_or(Some(1.0), |(_, own, wanted)| Some(own.parse::<f64>().ok()? / wanted.parse::<f64>().ok()?))
    };
    if let Some(share) =
        factor("width").zip(factor("height")).map(|(w, h)| w * h).filter(|share| *share > 0.0 && *share != 1.0)
    {
        let (inverse, of) = (1.0 / share, "of the pixels");
        told.push(if share < 1.0 { format!("1/{inverse:.0} {of}") } else { format!("{share:.0} times the pixels") });
    }
    told
}
