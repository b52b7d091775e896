//! Speedups from adjacent pairs: each run of a strategy beside a serial run of the same jobs, in alternating order.
//!
//! Cases that follow one another would leave the machine's drift in their ratios. A process has one memory layout, so the
//! pairs are repeated in further processes: this program starts itself with [`CASES`] in its environment.

use pathmark::analysis::Estimate;
use pathmark::analysis::adjacent_pairs::paired_ratio;
use pathmark::analysis::quantile::median;
use pathmark::analysis::ranking::{groups, told_apart_in_pairs};
use pathmark::measure::available_threads;
use std::collections::{BTreeMap, BTreeSet};
use std::env;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The variable that holds the names of the cases that a further process runs, separated by commas.
const CASES: &str = "PATHMARK_BENCH_CASES";
/// Further processes.
const PROCESSES: usize = 5;
/// Pairs of each case in a further process.
const PAIRS: usize = 8;
const LEVEL: f64 = 0.95;

/// Serial seconds over a case's own, by case; one list for each process.
#[derive(Default)]
pub(crate) struct Speedups(BTreeMap<String, Vec<Vec<f64>>>);

/// A strategy, its ratios by process, and its speedup.
type Compared<'a> = (&'a str, &'a Vec<Vec<f64>>, Estimate);

/// The name of a case.
pub(crate) fn name(strategy: &str, threads: &str) -> String {
    format!("{strategy}/{threads}")
}

/// Runs `own` so many times, each beside a run of `serial`; returns the seconds of `own`, and the ratios.
pub(crate) fn beside(times: u64, own: &mut dyn FnMut(), serial: &mut dyn FnMut()) -> (Duration, Vec<f64>) {
    let timed = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed()
    };
    let (mut sum, mut ratios) = (Duration::ZERO, Vec::new());
    for pair in 0..times {
        let [own, serial] = if pair % 2 == 0 {
            [timed(own), timed(serial)]
        } else {
            let serial = timed(serial);
            [timed(own), serial]
        };
        sum += own;
        ratios.push(serial.as_secs_f64() / own.as_secs_f64());
    }
    (sum, ratios)
}

/// In a further process: runs each of its cases by `pairs`, prints the ratios, and returns true.
pub(crate) fn is_further_process(mut pairs: impl FnMut(&str, u64) -> Option<Vec<f64>>) -> bool {
    let Ok(cases) = env::var(CASES) else { return false };
    for case in cases.split(',') {
        let ratios = pairs(case, PAIRS as u64).unwrap_or_default();
        println!("{case} {}", ratios.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
    }
    true
}

impl Speedups {
    /// Adds the ratios of a case in this process. Criterion runs a case many times; the first run of it warms it up.
    pub(crate) fn add(&mut self, case: &str, ratios: &[f64]) {
        let processes = self.0.entry(case.to_string()).or_insert_with(|| vec![Vec::new()]);
        processes[0].extend(ratios);
    }

    /// Repeats the pairs in further processes, and prints the speedups.
    pub(crate) fn finish(&mut self) {
        if !self.0.is_empty() {
            self.repeat();
            self.print(available_threads());
        }
    }

    /// Repeats all cases in further processes.
    fn repeat(&mut self) {
        let cases = self.0.keys().cloned().collect::<Vec<_>>().join(",");
        let Ok(own) = env::current_exe() else { return };
        for _ in 0..PROCESSES {
            let child = Command::new(&own).env(CASES, &cases).stdin(Stdio::null()).output();
            let Ok(output) = child else { continue };
            for line in String::from_utf8_lossy(&output.stdout).lines() {
                let mut words = line.split_whitespace();
                let ratios = self.0.get_mut(words.next().unwrap_or_default());
                let own: Vec<f64> = words.filter_map(|word| word.parse().ok()).collect();
                if let Some(processes) = ratios.filter(|_| !own.is_empty()) {
                    processes.push(own);
                }
            }
        }
    }

    /// Prints the speedups, the fastest first, thread count by thread count. Cases of one thread count that share a letter
    /// are not told apart.
    fn print(&self, processors: usize) {
        println!(
            "\nscheduling: speedup over serial, in adjacent pairs; 95 % interval over {} processes",
            PROCESSES + 1
        );
        println!("{:<20} {:>7} {:>8}   {:<16} letters", "strategy", "threads", "speedup", "interval");
        let mut by_threads: BTreeMap<&str, Vec<Compared<'_>>> = BTreeMap::new();
        for (case, processes) in &self.0 {
            let (Some((strategy, threads)), Some(found)) = (case.split_once('/'), paired_ratio(processes, LEVEL))
            else {
                continue;
            };
            by_threads.entry(threads).or_default().push((strategy, processes, found.ratio));
        }
        let mut beyond = Vec::new();
        for (threads, mut cases) in by_threads {
            cases.sort_by(|a, b| b.2.value.total_cmp(&a.2.value));
            // A process counts as one value, so cases are compared process by process.
            let slowness = cases.iter().map(|(_, processes, _)| {
                let value = |(number, own): (u32, &Vec<f64>)| Some(((number, None), 1.0 / median(own)?));
                (0..).zip(processes.iter()).filter_map(value).collect()
            });
            let slowness: Vec<BTreeMap<_, f64>> = slowness.collect();
            let sets = groups(cases.len(), &told_apart_in_pairs(&slowness, 1.0 - LEVEL));
            for (at, (strategy, _, Estimate { value, interval })) in cases.iter().enumerate() {
                let interval_text = format!("{:.3} to {:.3}", interval.low, interval.high);
                let letters = letters(&sets, at);
                println!("{strategy:<20} {threads:>7} {value:>8.3}   {interval_text:<16} {letters}");
                let most = threads.parse().map_or(processors, |threads: usize| threads.min(processors)) as f64;
                if interval.low > most {
                    beyond.push(format!("{strategy} on {threads}"));
                }
            }
        }
        println!("Cases of one number of threads that share a letter are not told apart (Holm, 5 % for each number).");
        if !beyond.is_empty() {
            println!(
                "In doubt, because no schedule can be faster than its processors: {}. Something slows their serial runs.",
                beyond.join(", ")
            );
        }
    }
}

fn letters(sets: &[BTreeSet<usize>], at: usize) -> String {
    let letter = |number: usize| char::from(b'a' + (number % 26) as u8);
    (0..sets.len()).filter(|number| sets[*number].contains(&at)).map(letter).collect()
}
