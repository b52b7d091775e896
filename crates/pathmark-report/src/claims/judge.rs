//! The judgement of claims by the results in some folders.

use super::condition::{Columns, Conditions};
use super::definition::{Claim, Report, Test};
use super::measure::{Evidence, Measurement};
use super::statistic::{Cases, GuardColumn, GuardValue, Statistic};
use super::verdict::Verdict;
use crate::cases_file::{self, CaseRow};
use crate::guard_prices::{self, PriceRow, read_prices};
use crate::lab::Lab;
use crate::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug)]
pub struct Answer<'a> {
    pub report: &'a Report,
    pub claim: &'a Claim,
    pub verdict: Verdict,
    /// The reason for the verdict, beyond the measured values.
    pub why: String,
    /// The file that the values come from, within the folders that were read.
    pub source: Option<PathBuf>,
    pub(super) found: Option<Measurement>,
}

impl Answer<'_> {
    /// Whether the verdict differs from those expected of a run at the report's own size. A verdict without comparable
    /// rows is never unexpected.
    pub fn is_unexpected(&self) -> bool {
        let is_silent = matches!(self.verdict, Verdict::NotAnswered | Verdict::NotComparable);
        !is_silent && !self.claim.expected_verdicts().any(|name| name == self.verdict.name())
    }
}

/// The results of a folder, read once for all claims.
struct Library<'a> {
    lab: &'a Arc<Lab>,
    out: &'a Path,
    experiments: BTreeMap<String, Option<Evidence>>,
    cases: Vec<CaseRow>,
    prices: Vec<PriceRow>,
}

/// Judges every claim by the results in some folders. Of several answers the first with comparable rows counts, or else
/// the first under other conditions.
pub fn judge<'a>(lab: &Arc<Lab>, reports: &'a [Report], folders: &[PathBuf]) -> Result<Vec<Answer<'a>>> {
    let mut libraries = folders.iter().map(|out| Library::open(lab, out)).collect::<Result<Vec<_>>>()?;
    let claims = reports.iter().flat_map(|report| report.claims.iter().map(move |claim| (report, claim)));
    let mut answers = Vec::new();
    for (report, claim) in claims {
        let answer =
            |verdict, why: &str| Answer { report, claim, verdict, why: why.to_string(), source: None, found: None };
        answers.push(match claim.test() {
            Err((verdict, why)) => answer(verdict, why),
            Ok(test) => {
                let mut best = answer(Verdict::NotAnswered, "The results have no such rows.");
                for library in &mut libraries {
                    let found = library.answer(report, claim, test)?;
                    if found.verdict.says() > best.verdict.says() {
                        best = found;
                    }
                }
                best
            }
        });
    }
    answers.sort_by_key(|answer| answer.claim.id);
    Ok(answers)
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

    fn answer<'c>(&mut self, report: &'c Report, claim: &'c Claim, test: &Test) -> Result<Answer<'c>> {
        let (found, source, differences) = match &test.statistic {
            Statistic::OfRows { experiment, rows, kind } => {
                let source = self.out.join(experiment).join("records.csv");
                match self.experiment(experiment)? {
                    None => (None, source, Vec::new()),
                    Some(evidence) => {
                        let found = evidence.measure(rows, kind, test.level)?;
                        let own: Vec<&Columns> = evidence.rows(rows).into_iter().map(|(_, columns)| columns).collect();
                        (found, source, differences(&test.comparable_if, &own))
                    }
                }
            }
            Statistic::Case(Cases { ids }) => {
                (self.failed_cases(ids), self.out.join(cases_file::FOLDER).join(cases_file::FILE), Vec::new())
            }
            Statistic::Guard(GuardValue { guard, column }) => {
                (self.price(guard, *column), self.out.join(guard_prices::FOLDER).join(guard_prices::FILE), Vec::new())
            }
        };
        let conditions = differences.join("; ");
        let (verdict, why) = match &found {
            None => (Verdict::NotAnswered, "The results have no such rows.".to_string()),
            Some(_) if !differences.is_empty() && !test.a_fortiori => (Verdict::NotComparable, conditions),
            Some(found) => (Verdict::of(found, test.predicted), conditions),
        };
        Ok(Answer { report, claim, verdict, why, source: found.is_some().then_some(source), found })
    }

    fn experiment(&mut self, name: &str) -> Result<Option<&Evidence>> {
        if !self.experiments.contains_key(name) {
            let folder = self.out.join(name);
            let evidence = if folder.join("records.csv").is_file() {
                Some(Evidence::of(Results::read(self.lab, self.out, &folder)?))
            } else {
                None
            };
            self.experiments.insert(name.to_string(), evidence);
        }
        Ok(self.experiments.get(name).and_then(Option::as_ref))
    }

    /// The number of these hard cases that failed, if all of them were tried.
    fn failed_cases(&self, ids: &[String]) -> Option<Measurement> {
        let tried = ids.iter().map(|id| self.cases.iter().find(|case| case.id == *id && case.trials > 0));
        let tried = tried.collect::<Option<Vec<&CaseRow>>>()?;
        let failed = tried.iter().filter(|case| !case.pass).count() as f64;
        Some(Measurement { value: failed, interval: Interval::between(failed, failed, 1.0), count: tried.len() })
    }

    fn price(&self, guard: &str, column: GuardColumn) -> Option<Measurement> {
        let row = self.prices.iter().find(|row| row.guard == guard)?;
        let (value, low, high) = match column {
            GuardColumn::ErrorWith => (row.error_with, row.error_with_low, row.error_with_high),
            GuardColumn::ErrorWithout => (row.error_without, row.error_without_low, row.error_without_high),
            GuardColumn::TimeRatio => (row.time_ratio?, row.time_ratio_low?, row.time_ratio_high?),
        };
        Some(Measurement { value, interval: Interval::between(low, high, guard_prices::LEVEL), count: 1 })
    }
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
