//! Grades of programs that add strategies: does each keep the contract and render the same image, and how many times as
//! fast as serial is it?
//!
//! The strategies of a program run beside the built-in ones in processes of that program, so they share its compiler and
//! its kernel. Two programs share no pair: their strategies are compared by their times relative to serial in the same
//! pair of their own program, whatever the machine did between the two.

use super::baseline::check_program;
use super::cell_process::ended;
use super::definition::Definition;
use super::diff::{Times, turn};
use super::process_group::answer;
use super::profile::Profile;
use super::ranking::MISS;
use super::records_file::{RECORDS, read_records};
use crate::analysis::Interval;
use crate::analysis::adjacent_pairs::{by_process, paired_ratio};
use crate::analysis::quantile::median;
use crate::analysis::ranking::{groups, told_apart_in_pairs};
use crate::error::{Error, InputError, Result};
use crate::lab::Lab;
use crate::measure::{Record, SERIAL};
use crate::strategy::contract::Violation;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use std::time::Duration;

/// The built-in strategies beside which programs are measured.
const REFERENCES: [&str; 5] = [SERIAL, "static-blocks", "shared-counter", "work-stealing", "rayon"];

/// Longest time of an answer that needs no run.
const ANSWER: Duration = Duration::from_mins(1);
/// The longest that jobs of a contract wait for each other.
const PATIENCE: Duration = Duration::from_secs(30);
/// Answers of a cell's process, far above the pairs of any definition of grades.
const MOST_ANSWERS: u32 = 64;
/// Confidence of the interval of a speedup.
const LEVEL: f64 = 0.95;
/// A strategy sleeps if in every run even its busiest worker spends more than this share of the time outside jobs.
const ASLEEP: f64 = 0.5;

/// A promise of the contract that a strategy breaks, as another process tells it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrokenPromise {
    /// Its name in [`crate::strategy::contract::Promise`], or `Process` if the test itself ended early.
    pub promise: String,
    pub says: String,
    pub case: String,
    pub found: String,
}

impl From<&Violation> for BrokenPromise {
    fn from(Violation { promise, case, found }: &Violation) -> Self {
        let (case, found) = (case.clone(), found.clone());
        Self { promise: format!("{promise:?}"), says: promise.to_string(), case, found }
    }
}

impl fmt::Display for BrokenPromise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}): {}", self.says, self.case, self.found)
    }
}

/// A program with strategies of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Candidate {
    program: PathBuf,
    /// Its name in tables and folders.
    pub label: String,
    pub strategies: Vec<String>,
}

/// The measurement of a program.
pub struct Trial<'a> {
    /// The definition of the experiment.
    pub definition: &'a Path,
    /// The folder for the program's rows and page.
    pub out: &'a Path,
    pub set: &'a [String],
    pub repetitions: u32,
    /// Time limit of each contract and of each run.
    pub limit: Duration,
}

#[derive(Deserialize)]
struct Listed {
    name: String,
    #[serde(default)]
    own: bool,
}

impl Candidate {
    /// Asks a program for the strategies that it adds. Refuses a program that adds none.
    pub fn ask(program: &Path, label: String) -> Result<Self> {
        check_program("program", program)?;
        let path = fs::canonicalize(program).map_err(|e| Error::system("finding", program, e))?;
        let refused = |problem: String| {
            let error = InputError::new("program", program.display().to_string(), problem);
            error.allowed("a program with pathmark::main(Lab::new().strategy(ENTRY))")
        };
        let listed = outcome(&path, ["list", "strategies", "--json"], ANSWER)
            .map_err(|problem| refused(format!("does not list its strategies ({problem})")))?;
        let listed: Vec<Listed> = serde_json::from_slice(&listed.stdout)
            .map_err(|e| refused(format!("does not list its strategies ({e})")))?;
        let strategies: Vec<String> = listed.into_iter().filter(|item| item.own).map(|item| item.name).collect();
        if strategies.is_empty() {
            return Err(refused("adds no strategy".to_string()).into());
        }
        Ok(Self { program: path, label, strategies })
    }

    /// The promises that a strategy breaks. A process that does not end within the limit breaks one, too.
    pub fn broken_promises(&self, strategy: &str, limit: Duration) -> Vec<BrokenPromise> {
        let patience = format!("{}ms", (limit / 6).min(PATIENCE).as_millis().max(1));
        let told = outcome(&self.program, ["contract", strategy, "--json", "--patience", &patience], limit);
        let broken = |promise: &str, says: &str, found: String| {
            let [promise, says] = [promise, says].map(str::to_string);
            vec![BrokenPromise { promise, says, case: "the whole contract".to_string(), found }]
        };
        let output = match told {
            Ok(output) => output,
            Err(found) => return broken("End", "a run ends when all its jobs have", found),
        };
        // A pool may print something before.
        let text = String::from_utf8_lossy(&output.stdout);
        let last = text.lines().next_back().and_then(|line| serde_json::from_str(line).ok());
        let said = String::from_utf8_lossy(&output.stderr);
        let found = || format!("it ended with {}: {}", output.status, said.trim());
        last.unwrap_or_else(|| broken("Process", "the process of the test ends with a verdict", found()))
    }

    /// Measures these strategies beside the built-in ones; returns the rows.
    pub fn measure(&self, strategies: &[&str], trial: &Trial<'_>) -> std::result::Result<Vec<Record>, String> {
        let names: Vec<&str> = REFERENCES.iter().chain(strategies).copied().collect();
        let values = std::iter::once(format!("strategy={}", names.join(","))).chain(trial.set.iter().cloned());
        let mut command = Command::new(&self.program);
        command.arg("run").arg(trial.definition).arg("--out").arg(trial.out).arg("--quiet");
        values.for_each(|pair| _ = command.arg("--set").arg(pair));
        command.args(["--repetitions", &trial.repetitions.to_string()]);
        command.args(["--timeout", &humantime::format_duration(trial.limit).to_string()]);
        let answers = trial.repetitions.saturating_mul(names.len() as u32).saturating_mul(MOST_ANSWERS);
        let output = waited(command, trial.limit.saturating_mul(answers))?;
        // A sweep with failed rows fails; its rows say why.
        let rows = rows_file(trial.definition, trial.out);
        if !rows.is_file() {
            return Err(ended(output.status, String::from_utf8_lossy(&output.stderr).trim()));
        }
        read_records(&rows).map_err(|error| error.to_string())
    }
}

/// The rows of an experiment in a folder of results.
fn rows_file(definition: &Path, out: &Path) -> PathBuf {
    out.join(definition.file_stem().unwrap_or_default()).join(RECORDS)
}

fn outcome(
    program: &Path,
    arguments: impl IntoIterator<Item = impl AsRef<OsStr>>,
    limit: Duration,
) -> std::result::Result<Output, String> {
    let mut command = Command::new(program);
    command.args(arguments);
    waited(command, limit)
}

fn waited(command: Command, limit: Duration) -> std::result::Result<Output, String> {
    let output = answer(command, "", Some(limit)).map_err(|error| format!("it cannot be run: {error}"))?;
    output.ok_or_else(|| format!("no end after {}", humantime::format_duration(limit)))
}

/// The checksum of the definition's image, rendered by this program; `None` if its sampler has none. Refuses values that
/// make several images or schedules.
pub fn own_checksum(lab: &Arc<Lab>, text: &str, set: &[String]) -> Result<Option<String>> {
    let definition = Definition::from_text(lab, "grade", "grade.toml", text)?.with_values(set)?;
    let cells = definition.cells(Profile::Quick)?;
    let serial = cells.iter().find(|cell| cell.settings.is_serial()).filter(|_| cells.len() == REFERENCES.len());
    let Some(serial) = serial else {
        let problem = "gives several images, or several schedules of a strategy";
        return Err(InputError::new("set", set.join(" "), problem).allowed("one value for each axis").into());
    };
    Ok(lab.prepare(serial.settings.clone())?.run(None)?.checksum)
}

/// The grade of a strategy.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Grade {
    /// Its program; `None` for a built-in strategy, which every program measures.
    pub program: Option<String>,
    pub strategy: String,
    /// The promises that it breaks.
    pub contract: Vec<BrokenPromise>,
    /// The faults of its runs.
    pub faults: Vec<String>,
    /// Serial time over its own in the same pair.
    pub speedup: Option<f64>,
    pub interval: Option<Interval>,
    /// Two strategies that share a group cannot be told apart.
    pub groups: Vec<usize>,
}

impl Grade {
    /// A strategy of a program, before its runs are judged.
    pub fn new(program: Option<&str>, strategy: &str, contract: Vec<BrokenPromise>) -> Self {
        let (program, strategy) = (program.map(str::to_string), strategy.to_string());
        Self { program, strategy, contract, faults: Vec::new(), speedup: None, interval: None, groups: Vec::new() }
    }

    pub fn is_passed(&self) -> bool {
        self.contract.is_empty() && self.faults.is_empty()
    }
}

/// The rows of each program, or the reason why there are none.
pub type Rows = BTreeMap<String, std::result::Result<Vec<Record>, String>>;

/// Completes the grades with the rows of each program, or with the reason why there are none, and adds the built-in
/// strategies. The fastest come first; strategies with a fault come last, without a speedup.
pub fn grades(own: Vec<Grade>, rows: &Rows, checksum: Option<&str>) -> Vec<Grade> {
    let mut judged = Vec::new();
    for mut grade in own {
        let rows = grade.program.as_ref().and_then(|program| rows.get(program));
        let times = match rows {
            Some(Ok(rows)) if grade.contract.is_empty() => {
                grade.faults = faults(rows, &grade.strategy, checksum);
                relative(rows, &grade.strategy)
            }
            Some(Err(problem)) if grade.contract.is_empty() => {
                grade.faults = vec![format!("its program could not be measured: {problem}")];
                Times::new()
            }
            _ => Times::new(),
        };
        judged.push((grade, times));
    }
    let programs: Vec<&Vec<Record>> = rows.values().filter_map(|rows| rows.as_ref().ok()).collect();
    for reference in REFERENCES {
        let mut found: BTreeMap<_, Vec<f64>> = BTreeMap::new();
        for (turn, ratio) in programs.iter().flat_map(|rows| relative(rows, reference)) {
            found.entry(turn).or_default().push(libm::log(ratio));
        }
        let mean = |own: &[f64]| libm::exp(own.iter().sum::<f64>() / own.len() as f64);
        let times: Times = found.into_iter().map(|(turn, own)| (turn, mean(&own))).collect();
        if !times.is_empty() {
            judged.push((Grade::new(None, reference, Vec::new()), times));
        }
    }
    ranked(judged)
}

fn ranked(judged: Vec<(Grade, Times)>) -> Vec<Grade> {
    let (mut timed, others): (Vec<_>, Vec<_>) =
        judged.into_iter().partition(|(grade, times)| grade.is_passed() && !times.is_empty());
    for (grade, times) in &mut timed {
        let gains = by_process(times.iter().map(|((process, _), ratio)| (*process, 1.0 / ratio)));
        let found = paired_ratio(&gains, LEVEL);
        // Serial has the ratio 1 in each pair, so it has no interval.
        let typical: Vec<f64> = gains.iter().filter_map(|own| median(own)).collect();
        grade.speedup = found.map(|found| found.ratio.value).or_else(|| median(&typical));
        grade.interval = found.map(|found| found.ratio.interval);
    }
    timed.sort_by(|(a, _), (b, _)| b.speedup.unwrap_or(0.0).total_cmp(&a.speedup.unwrap_or(0.0)));
    let times: Vec<Times> = timed.iter().map(|(_, times)| times.clone()).collect();
    for (number, set) in groups(times.len(), &told_apart_in_pairs(&times, MISS)).into_iter().enumerate() {
        for member in set {
            timed[member].0.groups.push(number);
        }
    }
    timed.into_iter().chain(others).map(|(grade, _)| grade).collect()
}

/// The times of a strategy relative to serial in the same pair.
fn relative(rows: &[Record], strategy: &str) -> Times {
    let times = |strategy: &str| -> Times {
        let own = rows.iter().filter(|row| row.strategy == strategy);
        own.filter_map(|row| Some((turn(row), row.makespan_s?))).collect()
    };
    let serial = times(SERIAL);
    times(strategy).into_iter().filter_map(|(turn, own)| Some((turn, own / serial.get(&turn)?))).collect()
}

/// The faults that the rows of a strategy show.
fn faults(rows: &[Record], strategy: &str, checksum: Option<&str>) -> Vec<String> {
    let own: Vec<&Record> = rows.iter().filter(|row| row.strategy == strategy).collect();
    if own.is_empty() {
        return vec!["it has no row".to_string()];
    }
    // The sweep compares with its first row, which may be the wrong one.
    let is_own = |error: &str| !error.is_empty() && !error.starts_with("checksum ");
    let failed = own.iter().find(|row| is_own(&row.error)).map(|row| row.error.clone());
    let other = own.iter().filter(|row| row.makespan_s.is_some() && !row.checksum.is_empty());
    let other = other.into_iter().find(|row| checksum.is_some_and(|checksum| row.checksum != checksum));
    let other = other.map(|row| {
        let expected = checksum.unwrap_or_default();
        format!("it renders another image: its checksum is {}, and this program's serial one {expected}", row.checksum)
    });
    let idle: Vec<f64> =
        own.iter().filter_map(|row| Some(1.0 - row.busy_max_s? / row.makespan_s.filter(|s| *s > 0.0)?)).collect();
    let is_asleep = !idle.is_empty() && idle.iter().all(|share| *share > ASLEEP);
    let asleep = median(&idle).filter(|_| is_asleep).map(|share| {
        format!("it sleeps: even its busiest worker spends {:.0} % of a run outside jobs (median)", 100.0 * share)
    });
    [failed, other, asleep].into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundredth more in some of four processes.
    const NOISE: [[f64; 4]; 3] = [[1.0, 1.01, 1.0, 1.01], [1.01, 1.0, 1.01, 1.0], [1.0, 1.01, 1.01, 1.0]];

    /// Four processes of two pairs, in which a strategy takes `factor` of the serial time, and noise.
    fn rows(strategies: &[(&str, f64)], noise: [f64; 4]) -> Vec<Record> {
        let mut rows = Vec::new();
        for (repetition, pair) in (0..4).flat_map(|process| [(process, 0), (process, 1)]) {
            let drift = 1.0 + 0.5 * f64::from(repetition);
            let noise = noise[repetition as usize];
            for (strategy, factor) in strategies.iter().chain(&[(SERIAL, 1.0)]) {
                let seconds = drift * factor * if *strategy == SERIAL { 1.0 } else { noise };
                rows.push(Record {
                    strategy: (*strategy).to_string(),
                    repetition,
                    pair: Some(pair),
                    makespan_s: Some(seconds),
                    busy_max_s: Some(0.9 * seconds),
                    checksum: "right".to_string(),
                    ..Record::default()
                });
            }
        }
        rows
    }

    fn graded(programs: Vec<(&str, Vec<Record>)>) -> Vec<Grade> {
        let own = programs.iter().map(|(name, _)| Grade::new(Some(name), "mine", Vec::new())).collect();
        let rows = programs.into_iter().map(|(name, rows)| (name.to_string(), Ok(rows))).collect();
        grades(own, &rows, Some("right"))
    }

    /// Two programs of one speed share a letter with each other and with a built-in strategy; a slower one has another.
    #[test]
    fn programs_that_cannot_be_told_apart_share_a_group() {
        let program = |factor: f64, at: usize| rows(&[("mine", factor), ("rayon", 0.5)], NOISE[at]);
        let found = graded(vec![("anna", program(0.5, 0)), ("bert", program(0.501, 1)), ("cleo", program(0.8, 2))]);
        let places: Vec<(&str, &[usize])> = found
            .iter()
            .map(|grade| (grade.program.as_deref().unwrap_or(&grade.strategy), grade.groups.as_slice()))
            .collect();
        assert!(places[..3].iter().all(|(_, groups)| *groups == [0]), "{places:?}");
        assert_eq!(places[3..], [("cleo", &[1][..]), ("serial", &[2])], "{places:?}");
        let [speedup, serial] = [3, 4].map(|place: usize| found[place].speedup.unwrap());
        assert!((speedup - 1.25).abs() < 0.02 && serial == 1.0, "{speedup} {serial}");
        assert!(found[3].interval.unwrap().contains(speedup) && found[4].interval.is_none());
    }

    #[test]
    fn faults_of_runs_are_named_and_have_no_speedup() {
        let of = |change: fn(&mut Record)| {
            let mut rows = rows(&[("mine", 0.5)], NOISE[0]);
            rows.iter_mut().filter(|row| row.strategy == "mine").for_each(change);
            let found = graded(vec![("anna", rows)]);
            let own = found.into_iter().find(|grade| grade.strategy == "mine").unwrap();
            assert!(own.speedup.is_none() && !own.is_passed(), "{own:?}");
            own.faults
        };
        assert!(of(|row| row.error = "timed-out: x".to_string())[0].starts_with("timed-out"));
        assert!(of(|row| row.checksum = "wrong".to_string())[0].contains("another image"));
        assert!(of(|row| row.busy_max_s = row.makespan_s.map(|s| 0.25 * s))[0].contains("75 % of a run outside jobs"));
        assert_eq!(of(|row| row.strategy = "other".to_string()), ["it has no row"]);
        // The sweep blames the second image for the checksum of the first.
        let mut rows = rows(&[("mine", 0.5)], NOISE[0]);
        for row in &mut rows {
            row.error = "checksum right instead of wrong".to_string();
        }
        assert_eq!(graded(vec![("anna", rows)])[0].faults, [""; 0]);
    }

    /// A worker that sleeps in some runs may have been kept waiting by another program.
    #[test]
    fn a_single_slow_run_is_no_sleep() {
        let mut rows = rows(&[("mine", 0.5)], NOISE[0]);
        rows[0].busy_max_s = Some(0.0);
        assert!(graded(vec![("anna", rows)]).iter().all(Grade::is_passed));
    }
}
