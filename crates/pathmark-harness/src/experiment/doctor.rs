//! The doctor: the machine's condition before a sweep, and the smallest difference that can be seen on it.
//!
//! Several processes time pairs of equal runs. The spread of the ratios is the noise with which a comparison of two
//! programs has to live here.

use super::process_group::answer;
use crate::analysis::adjacent_pairs::{Costs, FEWEST_PROCESSES, PowerPlan, cautious_spread, paired_ratio};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::input::read_text;
use crate::machine::{Fact, condition};
use crate::measure::{EqualPairs, ForeignLoad, utc_now};
use serde::{Deserialize, Serialize};
use std::env;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// The file's name in a folder of results.
pub const DOCTOR: &str = "doctor.json";

/// Most processes; a longer examination has longer ones.
const MOST_PROCESSES: usize = 8;
/// Shortest time of a process's pairs, in seconds.
const SHORTEST_S: f64 = 0.5;
/// The time of a comparison for which the noise is told.
const COMPARISON_S: f64 = 600.0;
const LEVEL: f64 = 0.95;
/// A process that takes so much longer than its pairs hangs.
const SLACK: Duration = Duration::from_mins(2);

/// The result of an examination.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Examination {
    /// When it began, in UTC.
    pub started_utc: String,
    pub facts: Vec<Fact>,
    /// `None` if the pairs of processes give no interval.
    pub noise: Option<Noise>,
}

/// The ratio of two equal programs, and what follows from its spread.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    pub processes: usize,
    pub pairs: usize,
    /// Mean seconds of a pair.
    pub pair_s: f64,
    /// The ratio, with its interval.
    pub ratio: f64,
    pub low: f64,
    pub high: f64,
    /// The most precise comparison in ten minutes.
    pub in_ten_minutes: PowerPlan,
}

impl Examination {
    /// Examines this machine in about so many seconds. `ask` starts the program for a process of pairs, which takes the
    /// seconds that it is given.
    pub fn now(seconds: f64, ask: impl Fn(&mut Command, f64)) -> Result<Self> {
        let started_utc = utc_now();
        let mut facts = condition();
        let processes = ((seconds / SHORTEST_S) as usize).clamp(FEWEST_PROCESSES, MOST_PROCESSES);
        let load = ForeignLoad::begin();
        let (mut pairs, mut start_s) = (Vec::new(), 0.0);
        for _ in 0..processes {
            let before = Instant::now();
            let own = ask_process(seconds / processes as f64, &ask)?;
            start_s += (before.elapsed().as_secs_f64() - own.seconds).max(0.0);
            pairs.push(own);
        }
        let shares = load.shares();
        let told = |share: f64| format!("{:.1} % of the processors", 100.0 * share);
        let advice = |share: f64, advice: &'static str| if share > 0.02 { advice } else { "" };
        facts.push(Fact::new(
            "other programs",
            shares.map(|shares| told(shares.programs)),
            shares.map_or("", |shares| advice(shares.programs, "close other programs")),
        ));
        facts.push(Fact::new(
            "steal",
            shares.map(|shares| told(shares.host)),
            shares.map_or("", |shares| {
                advice(shares.host, "the host gives processors to others: measure at another hour")
            }),
        ));
        Ok(Self { started_utc, facts, noise: Noise::of(&pairs, start_s / processes as f64) })
    }

    /// Its results in words.
    pub fn lines(&self) -> Vec<String> {
        let width = self.facts.iter().map(|fact| fact.name.len()).max().unwrap_or(0);
        let line = |fact: &Fact| {
            let advice = if fact.advice.is_empty() { String::new() } else { format!("  <- {}", fact.advice) };
            format!("{:width$}  {}{advice}", fact.name, fact.value)
        };
        let noise = self.noise.as_ref().map_or_else(|| vec![NO_NOISE.to_string()], Noise::lines);
        self.facts.iter().map(line).chain(noise).collect()
    }

    /// Writes the file.
    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|e| Error::system("writing", path, e.into()))?;
        atomic_file::write(path, |file| file.write_all(format!("{text}\n").as_bytes()))
    }

    /// Reads the file.
    pub fn read(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        serde_json::from_str(&text).map_err(|e| {
            let error = InputError::new("doctor", "", format!("is not the result of an examination: {e}"));
            error.in_file(path.display().to_string(), Some((e.line(), e.column()))).into()
        })
    }
}

const NO_NOISE: &str = "the pairs of equal runs give no interval: the machine's noise is unknown";

impl Noise {
    fn of(processes: &[EqualPairs], process_s: f64) -> Option<Self> {
        let ratios: Vec<Vec<f64>> = processes.iter().map(|own| own.ratios.clone()).collect();
        let found = paired_ratio(&ratios, LEVEL)?;
        let pair_s = processes.iter().map(|own| own.seconds).sum::<f64>() / found.pairs as f64;
        let interval = found.ratio.interval;
        Some(Self {
            processes: found.processes,
            pairs: found.pairs,
            pair_s,
            ratio: found.ratio.value,
            low: interval.low,
            high: interval.high,
            in_ten_minutes: cautious_spread(&ratios)?.narrowest(COMPARISON_S, LEVEL, Costs { pair_s, process_s })?,
        })
    }

    fn lines(&self) -> Vec<String> {
        let percent = |ratio: f64| 100.0 * (ratio - 1.0);
        let [ratio, low, high] = [self.ratio, self.low, self.high].map(percent);
        let mut lines = vec![
            format!(
                "two equal programs differ by {ratio:+.2} % ({low:+.2} % to {high:+.2} %) in {} pairs of {} processes",
                self.pairs, self.processes
            ),
            self.finding(),
        ];
        if !(self.low..=self.high).contains(&1.0) {
            lines.push(
                "the interval excludes 0 although the programs are equal: the machine's speed changes now".to_string(),
            );
        }
        lines
    }

    /// The smallest visible difference in a sentence.
    pub fn finding(&self) -> String {
        let PowerPlan { processes, pairs, half_width, .. } = self.in_ten_minutes;
        format!(
            "differences below {:.2} % cannot be seen in 10 minutes here ({processes} processes, in each {pairs} times a pair of {:.0} ms)",
            100.0 * half_width,
            1e3 * self.pair_s
        )
    }
}

/// The pairs of one process of this program.
fn ask_process(seconds: f64, ask: &impl Fn(&mut Command, f64)) -> Result<EqualPairs> {
    let own = env::current_exe().map_err(|e| Error::system("finding", "this program", e))?;
    let mut command = Command::new(&own);
    ask(&mut command, seconds);
    let limit = Duration::from_secs_f64(seconds) + SLACK;
    let output = answer(command, "", Some(limit)).map_err(|e| Error::system("running", &own, e))?;
    let output = output.ok_or_else(|| Error::Check(format!("a process of pairs did not end within {limit:?}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(Error::Check(format!("a process of pairs ended with {}: {}", output.status, said.trim())));
    }
    serde_json::from_slice(&output.stdout).map_err(|e| Error::Check(format!("a process of pairs gave no pairs: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pairs(ratios: [f64; 3]) -> EqualPairs {
        EqualPairs { ratios: ratios.to_vec(), seconds: 3.0 }
    }

    /// Three processes whose medians are 1/1.01, 1 and 1.01: the interval is Student's for their logarithms.
    #[test]
    fn the_smallest_visible_difference_follows_from_the_spread() {
        let processes = [0.99_f64, 1.0, 1.01].map(|middle| pairs([middle * 0.98, middle, middle * 1.02]));
        let noise = Noise::of(&processes, 0.5).unwrap();
        assert!((noise.processes, noise.pairs) == (3, 9) && (noise.pair_s - 1.0).abs() < 1e-12);
        assert!(noise.low < 1.0 && noise.high > 1.0 && noise.lines().len() == 2);
        let plan = noise.in_ten_minutes;
        assert!(plan.seconds <= 600.0 && plan.half_width < noise.high - 1.0, "{plan:?}");
        assert!(noise.finding().starts_with(&format!("differences below {:.2} % ", 100.0 * plan.half_width)));
        // Without any spread there is no interval.
        assert_eq!(Noise::of(&[pairs([1.0; 3]), pairs([1.0; 3]), pairs([1.0; 3])], 0.5), None);
    }

    #[test]
    fn an_interval_without_1_is_told() {
        let processes = [1.05_f64, 1.051, 1.052].map(|middle| pairs([middle; 3]));
        assert_eq!(Noise::of(&processes, 0.5).unwrap().lines().len(), 3);
    }

    #[test]
    fn files_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(DOCTOR);
        let processes = [0.99_f64, 1.0, 1.01].map(|middle| pairs([middle; 3]));
        let facts = vec![Fact::new("governor", None, ""), Fact::new("steal", Some("1".to_string()), "wait")];
        let written = Examination { started_utc: utc_now(), facts, noise: Noise::of(&processes, 0.5) };
        written.write(&path).unwrap();
        assert_eq!(Examination::read(&path).unwrap(), written);
        std::fs::write(&path, "{\n").unwrap();
        let error = Examination::read(&path).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains("doctor.json:2"), "{error}");
    }
}
