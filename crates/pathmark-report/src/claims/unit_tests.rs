//! Tests of the independent units behind a value: repetitions, pairs and runs.

use super::measurement::{Measurement, Rule};
use super::tests::{SECONDS, about, answer, claim, rows};
use super::*;
use crate::measure::Record;
use crate::tests::{folder_of, row};

/// The answer of several folders, in this order, to a claim about `an-experiment`.
fn of_folders(folders: &[&tempfile::TempDir], evidence: &str) -> (Verdict, String, Vec<String>, Option<Measurement>) {
    let text = claim(&format!("experiment = \"an-experiment\"\nlevel = 0.95\n{evidence}"));
    let reports = [Report::from_text("X.toml", &text).unwrap()];
    let paths: Vec<_> = folders.iter().map(|folder| folder.path().to_path_buf()).collect();
    let answer = judge(&Lab::built_in(), &reports, &paths).unwrap().remove(0);
    let notes = vec![answer.in_runs(), answer.settled_by(), answer.why.clone()];
    (answer.verdict, answer.measured(), notes, answer.found)
}

/// A folder of rows that take about so many seconds.
fn run(count: u32, seconds: f64) -> tempfile::TempDir {
    folder_of(&[], "", rows(count, |index, row| row.makespan_s = Some(about(seconds, index))))
}

/// Two runs confirm, one refutes, one is of another size: each order of the folders gives the same open verdict.
#[test]
fn no_order_of_folders_changes_a_verdict() {
    let small = folder_of(&[], "", rows(9, |_, row| row.width = 4));
    let all = [run(20, 1.0), run(21, 1.01), run(4, 2.0), small];
    let test = format!("{SECONDS}\nat-most = 1.5\ncomparable-if = {{ width = 8 }}");
    let mut orders = vec![Vec::new()];
    for _ in 0..all.len() {
        let longer = |order: &Vec<usize>| {
            let rest = (0..all.len())
                .filter(|place| !order.contains(place))
                .map(|place| [order.clone(), vec![place]].concat());
            rest.collect::<Vec<_>>()
        };
        orders = orders.iter().flat_map(longer).collect();
    }
    assert_eq!(orders.len(), 24);
    let answers =
        orders.iter().map(|order| of_folders(&order.iter().map(|place| &all[*place]).collect::<Vec<_>>(), &test));
    let answers: Vec<_> = answers.collect();
    assert!(answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
    let (verdict, _, notes, found) = &answers[0];
    assert_eq!((*verdict, notes[0].as_str()), (Verdict::Open, "confirmed in 2, refuted in 1 of 3 runs"));
    assert_eq!(found.unwrap().units, 45, "the rows of the other size are left out");
    assert!(found.unwrap().interval.unwrap().high < 1.5, "the runs together would confirm it");
    // A folder that is named twice is one run.
    assert_eq!(of_folders(&[&all[0], &all[0]], &test), of_folders(&[&all[0]], &test));
    // Rows of another size answer only if there are no others.
    assert_eq!(of_folders(&[&all[3]], &test).0, Verdict::NotComparable);
}

#[test]
fn runs_that_agree_make_a_verdict() {
    let all = [run(3, 1.0), run(4, 1.01), run(5, 1.02)];
    let of = |bound: &str| of_folders(&[&all[0], &all[1], &all[2]], &format!("{SECONDS}\n{bound}"));
    let (verdict, _, notes, found) = of("at-most = 1.5");
    assert_eq!((verdict, notes[0].as_str(), notes[1].as_str()), (Verdict::Confirmed, "in 3 of 3 runs", ""));
    assert_eq!((found.unwrap().units, found.unwrap().rule), (12, Rule::Median));
    assert_eq!((of("at-least = 1.5").0, of("at-least = 1.5").2[0].as_str()), (Verdict::Refuted, "in 3 of 3 runs"));
    // Each run alone has too few rows to tell 1.0 from 1.0005.
    let (verdict, _, notes, _) = of_folders(&[&all[0]], &format!("{SECONDS}\nat-most = 1.0005"));
    assert_eq!(verdict, Verdict::Open);
    assert!(notes[1].contains("more repetitions would settle it"), "{notes:?}");
}

/// Two repetitions decide nothing alone, however near to each other; those of three runs do.
#[test]
fn short_runs_are_judged_together() {
    let all = [run(2, 1.0), run(2, 1.01), run(2, 1.02)];
    let test = format!("{SECONDS}\nat-most = 1.5");
    let (verdict, _, notes, _) = of_folders(&[&all[0], &all[1], &all[2]], &test);
    assert_eq!((verdict, notes[0].as_str()), (Verdict::Confirmed, "over 3 runs, none long enough alone"));
    let (verdict, _, notes, _) = of_folders(&[&all[0], &run(5, 1.0)], &test);
    assert_eq!((verdict, notes[0].as_str()), (Verdict::Confirmed, "in 1 of 1 run, 1 too short alone"));
}

/// Rows of one run share the machine's condition on that day, so with six runs the runs are the units.
#[test]
fn many_runs_are_the_units() {
    let all: Vec<tempfile::TempDir> = (0..6).map(|day| run(9, 1.0 + 0.01 * f64::from(day))).collect();
    let found = of_folders(&all.iter().collect::<Vec<_>>(), &format!("{SECONDS}\nat-most = 1.5")).3.unwrap();
    assert_eq!((found.units, found.noun, found.rule), (6, "run", Rule::Median));
    assert!((found.interval.unwrap().low - 1.0).abs() < 1e-3 && (found.interval.unwrap().high - 1.05).abs() < 1e-3);
}

/// Four grids share the denominator of their repetition, and the pairs of a process its memory: both are one unit.
#[test]
fn pairs_that_share_something_are_one_unit() {
    let mut all = Vec::new();
    for repetition in 0..3 {
        for (grid, seconds) in [(4, 1.0), (16, 0.8), (25, 0.9), (36, 1.0), (49, 1.25)] {
            let decomposition = format!("grid:{grid}");
            let makespan_s = Some(about(seconds, repetition));
            all.push(Record { repetition, decomposition, makespan_s, ..row() });
        }
    }
    let ratio = "statistic = \"paired-ratio\"\ncolumn = \"makespan_s\"";
    let grids = format!(
        "{ratio}\nrows = {{ decomposition = [\"grid:16\", \"grid:25\", \"grid:36\", \"grid:49\"] }}\nover = {{ decomposition = \"grid:4\" }}\nat-most = 1.05"
    );
    let found = answer(&all, &grids).2.unwrap();
    assert_eq!((found.units, found.noun), (3, "repetition"));
    assert!((found.value - libm::pow(0.8 * 0.9 * 1.25, 0.25)).abs() < 1e-12, "{found:?}");

    let mut pairs = Vec::new();
    for repetition in 0..4 {
        for pair in 0..3 {
            for (strategy, seconds) in
                [("serial", 2.0), ("pool", 1.0 + 0.1 * f64::from(pair) + 0.01 * f64::from(repetition))]
            {
                let (strategy, cell) = (strategy.to_string(), strategy.to_string());
                pairs.push(Record { repetition, pair: Some(pair), strategy, cell, makespan_s: Some(seconds), ..row() });
            }
        }
    }
    let pool =
        "statistic = \"speedup\"\nrows = { strategy = \"pool\" }\nover = { strategy = \"serial\" }\nat-least = 1.0";
    let found = answer(&pairs, pool).2.unwrap();
    // The middle pair of each process takes 1.1 s and a little more.
    assert_eq!((found.units, found.noun), (4, "repetition"));
    assert!((found.value - 2.0 / 1.115).abs() < 1e-3, "{found:?}");
}

/// Logarithms -3d ... 3d of seven processes and one of 12d: their mean is 1.5d, their median .5d. Without pairs the claim takes
/// the median of the repetitions.
#[test]
fn a_ratio_of_pairs_is_that_of_figures() {
    let d = 0.01;
    let values = [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 12.0].map(|steps| libm::exp(d * steps));
    let pool = "statistic = \"paired-ratio\"\ncolumn = \"makespan_s\"\nrows = { strategy = \"pool\" }\nover = { strategy = \"serial\" }\nat-least = 0.5";
    let of = |pair: Option<u32>| {
        let mut all = Vec::new();
        for (repetition, value) in (0..).zip(values) {
            for (strategy, seconds) in [("serial", 1.0), ("pool", value)] {
                let (strategy, cell) = (strategy.to_string(), strategy.to_string());
                all.push(Record { repetition, pair, strategy, cell, makespan_s: Some(seconds), ..row() });
            }
        }
        answer(&all, pool).2.unwrap()
    };
    let (in_pairs, alone) = (of(Some(0)), of(None));
    assert_eq!((in_pairs.rule, alone.rule), (Rule::Pairs, Rule::Median));
    assert!((libm::log(in_pairs.value) - 1.5 * d).abs() < 1e-12, "{in_pairs:?}");
    assert!((libm::log(alone.value) - 0.5 * d).abs() < 1e-4, "{alone:?}");
    let figure = crate::analysis::adjacent_pairs::paired_ratio(&values.map(|value| vec![value]), 0.95).unwrap().ratio;
    let interval = in_pairs.interval.unwrap();
    assert!((interval.low - figure.interval.low).abs() < 1e-12 && (interval.high - figure.interval.high).abs() < 1e-12);
    let words = in_pairs.rule_in_words();
    assert_eq!(words, "geometric mean of 8 repetitions, interval of Student's t of logarithms");
}

/// Two groups of compared cells, one after the other, in eight processes with two pairs each. Within a group a ratio is of
/// pairs. Between groups it is of the processes' medians, although both groups count their pairs from 0.
#[test]
fn runs_of_two_groups_are_no_pairs() {
    let mut all = Vec::new();
    for repetition in 0..8 {
        for (at, (strategy, seconds)) in [("a", 1.0), ("b", 2.0), ("a", 1.2), ("b", 2.4), ("c", 3.0), ("d", 6.0)]
            .into_iter()
            .chain([("c", 4.0), ("d", 8.0)])
            .enumerate()
        {
            let (strategy, cell) = (strategy.to_string(), strategy.to_string());
            let (pair, place) = (Some((at / 2 % 2) as u32), Some((at % 2) as u32));
            let (run_order, makespan_s) =
                (u64::from(8 * repetition) + at as u64, Some(about(seconds, repetition + at as u32)));
            all.push(Record { repetition, pair, place, run_order, strategy, cell, makespan_s, ..row() });
        }
    }
    let of = |[above, below]: [&str; 2]| {
        let cells = format!("rows = {{ strategy = \"{above}\" }}\nover = {{ strategy = \"{below}\" }}");
        answer(&all, &format!("statistic = \"paired-ratio\"\ncolumn = \"makespan_s\"\n{cells}\nat-least = 0.5"))
            .2
            .unwrap()
    };
    let (within, between) = (of(["b", "a"]), of(["c", "a"]));
    assert_eq!((within.rule, between.rule, between.units), (Rule::Pairs, Rule::Median, 8));
    assert!((within.value - 2.0).abs() < 5e-3 && (between.value - 3.5 / 1.1).abs() < 8e-3, "{within:?}, {between:?}");
}
