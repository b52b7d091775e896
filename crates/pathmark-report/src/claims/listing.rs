//! Lists of verdicts: files, which a run with fewer rows must not replace, and a section of the page.

use super::definition::Report;
use super::escape::{cell, escaped, one_line, quotation};
use super::judge::{Age, Answer};
use super::verdict::{NAMES, Verdict};
use crate::analysis::Interval;
use crate::atomic_file;
use crate::block::Block;
use crate::error::{Error, InputError, Result};
use crate::files::Files;
use crate::page::{href, way};
use crate::plot::number;
use crate::prelude::{counted, joined};
use crate::table::Table;
use crate::words::capital;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Name of the verdicts' folder within the results.
pub const FOLDER: &str = "claims";
/// The verdicts as a text. It is beside the folders of the rows, so that its links work.
pub const MARKDOWN: &str = "CLAIMS.md";

const HEADING: &str = "# The claims of the four reports";
/// The first sentences below the heading, of verdicts and of numbers: with the heading they tell the program's own texts.
const OF_VERDICTS: &str = "`pathmark claims` computed every verdict from the rows that it links to.";
const OF_NUMBERS: &str = "`pathmark claims` computed every number from the rows that it links to.";
/// The beginning of a table of verdicts.
const COLUMNS: &str = "claim,report,verdict,expected,says,";

impl Answer<'_> {
    /// The measured value with its interval.
    pub fn measured(&self) -> String {
        self.found.map_or_else(|| "-".to_string(), |found| found.shown())
    }

    /// The rule that made value and interval, and the number of units.
    pub fn rule(&self) -> String {
        self.found.map_or_else(String::new, |found| found.rule_in_words())
    }

    /// How many runs alone have the verdict: `in 3 of 3 runs`; empty if no run was compared with the prediction.
    pub fn in_runs(&self) -> String {
        let of = |verdict: Verdict| self.runs.iter().filter(|run| **run == Some(verdict)).count();
        let (all, judged) = (self.runs.len(), self.runs.iter().flatten().count());
        match self.verdict {
            Verdict::NotComparable | Verdict::NotAnswered | Verdict::Context | Verdict::Measured => String::new(),
            _ if judged == 0 => format!("over {}, none long enough alone", counted(all, "run")),
            verdict if of(verdict) == judged => {
                let short = all - judged;
                let others = if short == 0 { String::new() } else { format!(", {short} too short alone") };
                format!("in {judged} of {}{others}", counted(judged, "run"))
            }
            _ => {
                let named = [Verdict::Confirmed, Verdict::Refuted, Verdict::Open].map(|verdict| (of(verdict), verdict));
                let told = named.iter().filter(|(count, _)| *count > 0);
                let told: Vec<String> = told.map(|(count, verdict)| format!("{verdict} in {count}")).collect();
                format!("{} of {}", told.join(", "), counted(judged, "run"))
            }
        }
    }

    /// How many more units would settle an open claim; empty if it is settled or that cannot be told.
    pub fn settled_by(&self) -> String {
        let Some((units, found)) = self.to_settle.zip(self.found) else { return String::new() };
        let each = if self.runs.iter().flatten().all(|run| *run == Verdict::Open) { "" } else { " in each open run" };
        format!("about {}{each} would settle it", counted(units, &format!("more {}", found.noun)))
    }

    /// Whether the claim was fixed before its rows were measured.
    pub fn age(&self) -> &'static str {
        match self.age {
            _ if self.found.is_none() || self.verdict == Verdict::Measured => "",
            Age::BoundFirst => "bound older than its rows",
            Age::RowsFirst => "bound younger than its rows",
            Age::Unknown => "rows without a time",
        }
    }

    /// The values that the report predicts.
    pub fn predicted(&self) -> String {
        let Some(predicted) = self.claim.test().ok().and_then(|test| test.predicted) else { return "-".to_string() };
        let short = |value: f64| number::short(value, 6);
        match predicted {
            [low, high] if low == high => short(low),
            [low, f64::INFINITY] => format!("at least {}", short(low)),
            [f64::NEG_INFINITY, high] => format!("at most {}", short(high)),
            [low, high] => format!("{} to {}", short(low), short(high)),
        }
    }

    /// The statistic in words.
    fn question(&self) -> String {
        self.claim.test().map_or_else(|_| String::new(), |test| test.statistic.to_string())
    }

    /// The files of its rows, as one text.
    pub fn source(&self) -> Option<String> {
        let sources: Vec<String> = self.sources.iter().map(|source| source.display().to_string()).collect();
        Some(sources.join("; ")).filter(|sources| !sources.is_empty())
    }

    /// The measured value as a number.
    pub fn value(&self) -> Option<f64> {
        Some(self.found?.value)
    }

    /// The ends of its interval, and their confidence.
    pub fn interval(&self) -> Option<Interval> {
        self.found?.interval
    }
}

/// The files of verdicts: `CLAIMS.md` and `claims/claims.csv` for the four reports, and others for a ledger.
pub struct Listing {
    stem: String,
    heading: String,
}

impl Listing {
    pub fn of_reports() -> Self {
        Self { stem: FOLDER.to_string(), heading: HEADING.to_string() }
    }

    /// Files with the name of the ledger, or of a folder of ledgers: `FINDINGS.md` and `claims/findings.csv` for
    /// `findings.toml`.
    pub fn of_ledgers(path: &Path, ledgers: &[Report]) -> Self {
        let name = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        let stem = name.file_stem().unwrap_or_default().to_string_lossy().to_lowercase();
        Self { heading: heading(ledgers, &stem), stem }
    }

    /// The verdicts of an artifact, which keeps no name of a folder of ledgers.
    pub fn of_artifact(ledgers: &[Report]) -> Self {
        let names: Vec<&str> = ledgers.iter().map(|ledger| ledger.report.as_str()).collect();
        Self { heading: heading(ledgers, &names.join(", ")), stem: FOLDER.to_string() }
    }

    /// The verdicts as a text whose links begin at this folder.
    pub fn markdown_of(&self, answers: &[Answer<'_>], base: &Path) -> String {
        markdown(&self.heading, answers, base)
    }

    fn csv(&self, out: &Path) -> PathBuf {
        out.join(FOLDER).join(format!("{}.csv", self.stem))
    }

    fn markdown(&self, out: &Path) -> PathBuf {
        out.join(format!("{}.md", self.stem.to_uppercase()))
    }

    /// Enters the files into those of a command that will write them. A new file may replace an old one of the same
    /// reports.
    pub fn enter(&self, option: &str, out: &Path, files: &mut Files, reports: &[Report]) -> Result<()> {
        let [table, text] = [self.csv(out), self.markdown(out)];
        files.renews(option, &table, |path| text_of(path).starts_with(COLUMNS))?;
        files.renews(option, &text, |path| is_listing(path, &self.heading))?;
        let is_other = |name: &String| reports.iter().all(|report| report.report != *name);
        let names = rows_of(&table).filter_map(|row| row.get(1).map(str::to_string));
        if let Some(other) = names.filter(is_other).min() {
            let problem = format!("has verdicts on the report {other}, which this ledger does not have");
            let error = InputError::new(option, table.display().to_string(), problem);
            return Err(error.allowed("another folder, or another name of the ledger").into());
        }
        Ok(())
    }

    /// Writes the files into a folder of results.
    pub fn save(&self, answers: &[Answer<'_>], out: &Path) -> Result<()> {
        let folder = out.join(FOLDER);
        std::fs::create_dir_all(&folder).map_err(|e| Error::system("creating", &folder, e))?;
        if let Block::Table { table, .. } = table("claims", answers) {
            table.save(&self.csv(out))?;
        }
        let text = markdown(&self.heading, answers, out);
        atomic_file::write(&self.markdown(out), |file| file.write_all(text.as_bytes()))
    }

    /// Refuses to write verdicts into a folder whose files answer claims that these leave open to another run.
    pub fn check_no_loss(&self, option: &str, answers: &[Answer<'_>], out: &Path) -> Result<()> {
        let path = self.csv(out);
        let verdict = |row: csv::StringRecord| Some((row.get(0)?.parse().ok()?, Verdict::named(row.get(2)?)?));
        let kept: BTreeMap<u32, Verdict> = rows_of(&path).filter_map(verdict).collect();
        // A claim that asks for no rows any more loses none.
        let is_lost = |answer: &&Answer<'_>| {
            let says_more = kept.get(&answer.claim.id).is_some_and(|kept| kept.says() > answer.verdict.says());
            says_more && answer.claim.test().is_ok()
        };
        let lost: Vec<String> = answers.iter().filter(is_lost).map(|answer| answer.claim.id.to_string()).collect();
        if !lost.is_empty() {
            let problem = format!("answers claims that these rows do not answer: {}", lost.join(", "));
            let error = InputError::new(option, path.display().to_string(), problem);
            return Err(error.allowed("another folder, or more folders of rows").into());
        }
        Ok(())
    }
}

/// The rows of a table of verdicts; none if there is no such file.
fn rows_of(path: &Path) -> impl Iterator<Item = csv::StringRecord> {
    csv::Reader::from_path(path).into_iter().flat_map(csv::Reader::into_records).filter_map(std::result::Result::ok)
}

fn table(stem: &'static str, answers: &[Answer<'_>]) -> Block {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let of = |answer: &Answer<'_>| answer.found;
    Block::table(stem, "Claims and verdicts", answers)
        .column("claim", |a| a.claim.id.to_string())
        .column("report", |a| a.report.report.clone())
        .column("verdict", |a| a.verdict.name().to_string())
        .column("expected", |a| a.claim.expected.clone())
        .column("says", |a| a.claim.claim.clone())
        .column("quote", |a| a.claim.quote.clone())
        .column("place", |a| a.claim.place.clone())
        .column("reported", |a| a.claim.reported.clone())
        .column("statistic", |a| a.question())
        .column("predicted", |a| a.predicted())
        .column("measured", |a| number(a.value()))
        .column("low", |a| number(a.interval().map(|interval| interval.low)))
        .column("high", |a| number(a.interval().map(|interval| interval.high)))
        .column("level", |a| number(a.interval().map(|interval| interval.level)))
        .column("values", |a| number(of(a).map(|found| found.units as f64)))
        .column("source", |a| a.source().unwrap_or_default())
        .column("why", |a| a.why.clone())
        .column("unit", |a| of(a).map_or_else(String::new, |found| found.noun.to_string()))
        .column("rule", |a| a.rule())
        .column("runs", |a| a.in_runs())
        .column("to_settle", |a| number(a.to_settle.map(|units| units as f64)))
        .column("frozen", |a| a.claim.frozen_utc().to_string())
        .column("age", |a| a.age().to_string())
        .end()
}

/// The heading of a ledger, or of several with this name.
fn heading(ledgers: &[Report], several: &str) -> String {
    match ledgers {
        [one] => format!("# {}", one.title.trim()),
        _ => format!("# The claims of {several}"),
    }
}

/// Whether a file is such a text, which a new one may replace.
pub fn is_markdown(path: &Path) -> bool {
    is_listing(path, HEADING)
}

/// Whether a file begins with this heading and the program's sentence below it. Anybody's text may begin with the heading.
fn is_listing(path: &Path, heading: &str) -> bool {
    let text = text_of(path);
    let below = text.strip_prefix(heading).and_then(|rest| rest.strip_prefix("\n\n")).unwrap_or_default();
    below.starts_with(OF_VERDICTS) || below.starts_with(OF_NUMBERS)
}

/// The text of a file; empty if it has none.
fn text_of(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// The verdicts on claims with a prediction.
fn judged() -> impl Iterator<Item = &'static str> {
    NAMES.into_iter().filter(|name| *name != Verdict::Measured.name())
}

/// The number of claims of each report with each verdict.
fn counts(answers: &[Answer<'_>]) -> Vec<(String, Vec<usize>)> {
    let mut reports: Vec<&str> = answers.iter().map(|answer| answer.report.report.as_str()).collect();
    reports.sort_unstable();
    reports.dedup();
    let of = |report: &str, name: &str| {
        answers.iter().filter(|a| a.report.report == report && a.verdict.name() == name).count()
    };
    reports.iter().map(|report| ((*report).to_string(), judged().map(|name| of(report, name)).collect())).collect()
}

/// The path of a file as seen from a folder; the path itself if either is not there.
fn seen_from(folder: &Path, file: &Path) -> PathBuf {
    let complete = folder.canonicalize().ok().zip(file.canonicalize().ok());
    complete.map_or_else(|| file.to_path_buf(), |(from, to)| way(&from, &to))
}

/// The verdicts as a text; paths of sources are relative to `base`. Findings are a table.
fn markdown(heading: &str, answers: &[Answer<'_>], base: &Path) -> String {
    let is_finding = |answer: &&Answer<'_>| answer.claim.test().is_ok_and(|test| test.predicted.is_none());
    let (findings, claims): (Vec<&Answer<'_>>, Vec<&Answer<'_>>) = answers.iter().partition(is_finding);
    let mut text = format!("{heading}\n");
    if !claims.is_empty() {
        let _ = write!(
            text,
            "\n{OF_VERDICTS} A claim is *confirmed* if the whole interval lies within the values \
             that the report predicts, *refuted* if it lies wholly outside, and *open* otherwise. Each folder is a run; a claim whose runs differ is open. It is *not comparable* if the rows \
             were measured under other conditions, and *not answered* if there are no rows.\n\n",
        );
        let names: Vec<String> = judged().map(|name| name.replace('-', " ")).collect();
        let _ = writeln!(text, "| report | {} |", names.join(" | "));
        let _ = writeln!(text, "|--|{}", "--:|".repeat(names.len()));
        for (report, counts) in counts(answers) {
            let counts: Vec<String> = counts.iter().map(ToString::to_string).collect();
            let _ = writeln!(text, "| {} | {} |", cell(&report), counts.join(" | "));
        }
    }
    let mut last: Option<&Report> = None;
    let mut ordered = claims;
    ordered.sort_by_key(|answer| (&answer.report.report, answer.claim.id));
    for answer in ordered {
        if last.is_none_or(|last| last.report != answer.report.report) {
            let Report { report, title, about, source, doi, .. } = answer.report;
            let _ = write!(text, "\n## Report {report}: {title}\n\n{}\n", about.trim());
            let doi = Some(doi).filter(|doi| !doi.is_empty()).map(|doi| format!("<https://doi.org/{doi}>"));
            let cited = joined([source.clone(), doi.unwrap_or_default()]);
            if !cited.is_empty() {
                let _ = write!(text, "\nSource: {cited}\n");
            }
            last = Some(answer.report);
        }
        text.push_str(&entry(answer, base));
    }
    if let Some(first) = findings.first() {
        if last.is_none() {
            let _ = write!(text, "\n{OF_NUMBERS}\n");
        }
        let _ = write!(
            text,
            "\n{}\n\n| finding | measured | interval | rows |\n|--|--|--|--|\n",
            first.report.about.trim()
        );
        for answer in findings {
            let numbers = match &answer.found {
                Some(found) => format!("{} | {}; {}", found.shown(), found.confidence(), found.rule_in_words()),
                None => format!("- | {}", cell(&answer.why)),
            };
            let _ = writeln!(text, "| {} | {numbers} | {} |", cell(&answer.claim.claim), links(answer, base));
        }
    }
    text
}

/// Links to the files of an answer's rows.
fn links(answer: &Answer<'_>, base: &Path) -> String {
    let shown = answer.sources.iter().map(|source| seen_from(base, source).display().to_string());
    shown.map(|shown| format!("[{shown}]({})", href(&shown))).collect::<Vec<_>>().join(", ")
}

fn entry(answer: &Answer<'_>, base: &Path) -> String {
    let claim = answer.claim;
    let says = one_line(&claim.claim);
    let mut text = format!("\n### {}. {says}\n\n**{}**", claim.id, capital(&answer.verdict.to_string()));
    for part in [answer.in_runs(), answer.settled_by()].iter().filter(|part| !part.is_empty()) {
        let _ = write!(text, ", {part}");
    }
    if !answer.why.is_empty() {
        let _ = write!(text, ": {}", one_line(&answer.why));
    }
    let [place, reported] = [&claim.place, &claim.reported].map(|words| escaped(&one_line(words)));
    let _ = write!(text, "\n\n{} ({place})\n\n- Reported: {reported}\n", quotation(&claim.quote));
    if let Some(found) = &answer.found {
        let links = links(answer, base);
        let level = Some(found.confidence()).filter(|level| !level.is_empty());
        let level = level.map_or_else(String::new, |level| format!(", {level}"));
        let (measured, rule, question) = (found.shown(), found.rule_in_words(), answer.question());
        let _ = writeln!(text, "- Measured: {measured}{level}; {question}; {rule}; {links}");
        let reason = Some(one_line(&claim.reason)).filter(|reason| !reason.is_empty());
        let reason = reason.map_or_else(String::new, |reason| format!(". {reason}"));
        let _ = writeln!(text, "- Predicted: {}{reason}", answer.predicted());
        let _ = writeln!(text, "- Fixed at {}: {}", claim.fixed(), answer.age());
    }
    if !claim.changed.is_empty() {
        let _ = writeln!(text, "- Changed: {}", one_line(&claim.changed));
    }
    if !claim.note.is_empty() {
        let _ = writeln!(text, "- {}", one_line(&claim.note));
    }
    text
}

/// The number of claims with each verdict, in a sentence.
pub(super) fn in_short(answers: &[Answer<'_>]) -> String {
    let (all, totals) = (answers.len(), totals(answers));
    format!("Verdicts on {all} claims, computed from these rows: {totals}.")
}

/// The number of claims with each verdict, without those that none has: `2 confirmed, 1 open`.
pub fn totals(answers: &[Answer<'_>]) -> String {
    let count = |name: &str| answers.iter().filter(|answer| answer.verdict.name() == name).count();
    let counts = NAMES.iter().map(|name| (count(name), name.replace('-', " "))).filter(|(count, _)| *count > 0);
    counts.map(|(count, name)| format!("{count} {name}")).collect::<Vec<String>>().join(", ")
}

/// The verdicts for the page: counts, and a table for each report.
pub(crate) fn blocks(answers: &[Answer<'_>]) -> Vec<Block> {
    let heads: Vec<String> = std::iter::once("report").chain(judged()).map(|name| name.replace('-', " ")).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows = counts(answers).into_iter().map(|(report, counts)| {
        std::iter::once(report).chain(counts.iter().map(ToString::to_string)).collect::<Vec<String>>()
    });
    let verdicts = Table::of_text("Verdicts", &heads, &rows.collect::<Vec<_>>());
    let mut blocks = vec![Block::Table { stem: "verdicts", table: verdicts }];
    let reports: BTreeSet<&str> = answers.iter().map(|answer| answer.report.report.as_str()).collect();
    let reports: Vec<&str> = reports.into_iter().collect();
    let (unanswered, answered): (Vec<&Answer<'_>>, Vec<&Answer<'_>>) =
        answers.iter().partition(|answer| answer.verdict == Verdict::NotAnswered);
    for (at, stem) in ["claims-a", "claims-b", "claims-c", "claims-d", "claims-e", "claims-f"].into_iter().enumerate() {
        let mut own: Vec<&Answer<'_>> = match reports.get(at) {
            Some(letter) => answered.iter().copied().filter(|answer| answer.report.report == *letter).collect(),
            None => break,
        };
        // Those that rows have judged come first.
        own.sort_by_key(|answer| (std::cmp::Reverse(answer.verdict.says()), answer.claim.id));
        let Some(first) = own.first() else { continue };
        let letter = &first.report.report;
        blocks.push(Block::finding(format!("Report {letter}, {}. {}", first.report.title, first.report.about.trim())));
        let title = format!("Report {letter}: claims and verdicts");
        blocks.push(
            Block::table(stem, title, own)
                .column("claim", |a| format!("{}. {}", a.claim.id, a.claim.claim))
                .column("verdict", |a| joined([a.verdict.to_string(), a.in_runs(), a.settled_by()]))
                .column("measured", |a| a.measured())
                .column("predicted", |a| a.predicted())
                .column("the report says", |a| format!("\u{201c}{}\u{201d}", a.claim.quote))
                .column("reported", |a| a.claim.reported.clone())
                .column("interval", |a| a.rule())
                .column("conditions", |a| joined([a.why.clone(), a.age().to_string()]))
                .end(),
        );
    }
    if !unanswered.is_empty() {
        let count = counted(unanswered.len(), "claim");
        blocks.push(Block::notice(format!(
            "{count} of the reports cannot be answered by these rows. `pathmark reproduce --reports` measures what they need."
        )));
        blocks.push(
            Block::table("claims-unanswered", "Claims without rows here", unanswered)
                .column("claim", |a| format!("{}. {}", a.claim.id, a.claim.claim))
                .column("report", |a| a.report.report.clone())
                .column("verdict", |a| a.verdict.to_string())
                .end(),
        );
    }
    blocks
}
