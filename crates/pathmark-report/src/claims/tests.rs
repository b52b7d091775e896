use super::condition::{Columns, Conditions, columns, text};
use super::definition::Test;
use super::judge::Age;
use super::measure::identity;
use super::measurement::{Measurement, Rule};
use super::statistic::{Kind, Statistic};
use super::*;
use crate::cases_file::{self, CaseRow};
use crate::error::Error;
use crate::experiment::{Cell, Definition, Profile};
use crate::guard_prices;
use crate::measure::Record;
use crate::tests::{folder_of, row};
use std::collections::{BTreeMap, BTreeSet};

pub(super) const SECONDS: &str = "statistic = \"value\"\ncolumn = \"makespan_s\"";
const HEAD: &str = "report = \"X\"\ntitle = \"T\"\nabout = \"Who.\"\n";

pub(super) fn claim(evidence: &str) -> String {
    let words = "quote = \"q\"\nplace = \"p\"\nreported = \"r\"\nclaim = \"c\"\nexpected = \"confirmed\"\nfrozen = \"2026-01-01T00:00:00Z\"\nreason = \"w\"\n";
    format!("{HEAD}[[claim]]\nid = 1\n{words}{evidence}\n")
}

/// The answer of these rows to a claim about `an-experiment`: the verdict, the reason for it, and the measured value.
pub(super) fn answer(rows: &[Record], evidence: &str) -> (Verdict, String, Option<Measurement>) {
    let out = folder_of(&[], "", rows.to_vec());
    let text = claim(&format!("experiment = \"an-experiment\"\nlevel = 0.95\n{evidence}"));
    let reports = [Report::from_text("X.toml", &text).unwrap()];
    let answers = judge(&Lab::built_in(), &reports, &[out.path().to_path_buf()]).unwrap();
    (answers[0].verdict, answers[0].why.clone(), answers[0].found)
}

/// The verdict on a claim about `an-experiment` with these rows, and why.
fn verdict(rows: &[Record], evidence: &str) -> (Verdict, String) {
    let (verdict, why, _) = answer(rows, evidence);
    (verdict, why)
}

/// Rows that differ by `change`, which gets the index of the row.
pub(super) fn rows(count: u32, change: impl Fn(u32, &mut Record)) -> Vec<Record> {
    let changed = |index: u32| {
        let mut row = Record { repetition: index, ..row() };
        change(index, &mut row);
        row
    };
    (0..count).map(changed).collect()
}

/// A value near `value` that depends on the index.
pub(super) fn about(value: f64, index: u32) -> f64 {
    value * (1.0 + 0.001 * (f64::from(index % 5) - 2.0))
}

/// A prediction from `low` to `high` is confirmed, and the ranges beside it are refuted.
fn both_ways(rows: &[Record], evidence: &str, [low, high]: [f64; 2]) {
    let with = |a: f64, b: f64| verdict(rows, &format!("{evidence}\nwithin = [{a:?}, {b:?}]")).0;
    assert_eq!(with(low, high), Verdict::Confirmed, "{evidence}");
    assert_eq!(with(high, high + 1.0), Verdict::Refuted, "{evidence}");
    assert_eq!(with(low - 1.0, low), Verdict::Refuted, "{evidence}");
}

#[test]
fn values_and_counts() {
    let rows = rows(9, |index, row| {
        row.makespan_s = Some(about(2.0, index));
        (row.cpu_user_s, row.cpu_system_s) = (Some(about(1.5, index)), Some(about(0.5, index + 1)));
        row.invalid_samples = Some(3);
    });
    both_ways(&rows, "statistic = \"value\"\ncolumn = \"makespan_s\"", [1.9, 2.1]);
    both_ways(&rows, "statistic = \"value\"\ncolumn = \"makespan_s\"\nper = \"spp\"", [0.4, 0.6]);
    both_ways(
        &rows,
        "statistic = \"value\"\ncolumn = \"cpu_user_s\"\nplus = \"cpu_system_s\"\nper = \"makespan_s\"",
        [0.99, 1.01],
    );
    both_ways(&rows, "statistic = \"count\"\ncolumn = \"invalid_samples\"", [26.5, 27.5]);
}

#[test]
fn an_interval_across_the_end_of_the_prediction_is_open() {
    let rows = rows(9, |index, row| row.makespan_s = Some(about(2.0, index)));
    let value = "statistic = \"value\"\ncolumn = \"makespan_s\"";
    assert_eq!(verdict(&rows, &format!("{value}\nat-least = 2.0")).0, Verdict::Open);
    assert_eq!(verdict(&rows, &format!("{value}\nat-least = 1.9")).0, Verdict::Confirmed);
    assert_eq!(verdict(&rows, &format!("{value}\nat-most = 1.9")).0, Verdict::Refuted);
    assert_eq!(verdict(&rows[..1], &format!("{value}\nat-least = 1.0")).0, Verdict::Open, "one value");
    assert_eq!(verdict(&rows[..4], &format!("{value}\nat-least = 1.0")).0, Verdict::Confirmed, "four values");
}

#[test]
fn ratios_pair_rows_by_all_that_the_claim_does_not_name() {
    // The repetitions differ in speed, and the pool is three times as fast in each: without pairs the ratio would be
    // hidden.
    let mut all = Vec::new();
    for repetition in 0..7 {
        let slow = f64::from(1 << repetition);
        for (strategy, threads, seconds) in [("serial", 1, 3.0), ("pool", 2, 1.0)] {
            let mut row = Record { repetition, threads, strategy: strategy.to_string(), ..row() };
            row.makespan_s = Some(about(seconds * slow, repetition + threads as u32));
            all.push(row);
        }
    }
    let pool = "rows = { strategy = \"pool\", threads = 2 }\nover = { strategy = \"serial\", threads = 1 }";
    both_ways(&all, &format!("statistic = \"speedup\"\n{pool}"), [2.9, 3.1]);
    let ratio = format!("statistic = \"paired-ratio\"\ncolumn = \"makespan_s\"\n{pool}");
    both_ways(&all, &ratio, [0.32, 0.34]);
    // Rows that differ in a column that the claim does not name are not compared.
    for row in all.iter_mut().filter(|row| row.strategy == "serial") {
        row.decomposition = "rows".to_string();
    }
    assert_eq!(verdict(&all, &format!("statistic = \"speedup\"\n{pool}\nat-least = 1.0")).0, Verdict::NotAnswered);
}

/// Images that differ in any setting are no partners, also if only the filter or the epsilon differs.
#[test]
fn ratios_pair_rows_of_the_same_image() {
    let images: [fn(&mut Record); 3] =
        [|_| (), |row| row.filter = "box".to_string(), |row| row.epsilon = "1e-4".to_string()];
    let mut all = Vec::new();
    for (slow, change) in [1.0, 10.0, 100.0].into_iter().zip(images) {
        for repetition in 0..6 {
            for (strategy, seconds) in [("serial", 2.0), ("pool", 1.0)] {
                let mut row = Record { repetition, strategy: strategy.to_string(), ..row() };
                change(&mut row);
                row.makespan_s = Some(about(seconds * slow, repetition));
                all.push(row);
            }
        }
    }
    let pool = "statistic = \"speedup\"\nrows = { strategy = \"pool\" }\nover = { strategy = \"serial\" }";
    both_ways(&all, pool, [1.99, 2.01]);
}

/// Rows of other samples per pixel, other sizes or other repetitions of a seed are no further seeds, and none of them
/// replaces another. Seed s has the mean s at 4, 8 and 16 samples together; the shift from b to a is 1.
#[test]
fn only_seeds_are_independent() {
    let mut all = Vec::new();
    for seed in 1..=4u64 {
        for (estimator, shift, order) in [("bsdf", 1.0, 1.0), ("mis", 0.0, -1.0)] {
            for (spp, offset) in [(4, -1.0), (8, 0.0), (16, 1.0)] {
                for repetition in 0..2 {
                    let mean = 10.0 + seed as f64 + shift + order * offset;
                    let mut row = Record { repetition, seed, spp, estimator: estimator.to_string(), ..row() };
                    (row.mean_radiance, row.mse) = (Some(mean), Some(1.0 / f64::from(spp) / seed as f64));
                    all.push(row);
                }
            }
        }
    }
    let pair = "statistic = \"mean-ratio\"\ncolumn = \"mean_radiance\"\nrows = { estimator = \"bsdf\" }\nover = { estimator = \"mis\" }\nwithin = [-9, 9]";
    let found = answer(&all, pair).2.unwrap();
    assert!((found.value - 13.5 / 12.5).abs() < 1e-12, "{found:?}");
    assert_eq!((found.units, found.rule), (4, Rule::Welch { others: 4 }), "four seeds on either side");
    let slope = "statistic = \"rmse-slope\"\nrows = { estimator = \"mis\" }\nwithin = [-0.6, -0.4]";
    assert_eq!(answer(&all, slope).2.unwrap().units, 4);
    // A second size with thrice the squared error triples no count and leaves the exponent as it is.
    let larger = all.iter().map(|row| Record { width: 16, mse: row.mse.map(|mse| 3.0 * mse), ..row.clone() });
    let both: Vec<Record> = larger.chain(all.clone()).collect();
    let found = answer(&both, slope).2.unwrap();
    assert!(found.units == 4 && (found.value + 0.5).abs() < 1e-9, "{found:?}");
}

#[test]
fn exponents_and_slopes() {
    let points = rows(12, |index, row| {
        row.spp = 1 << (index % 4);
        row.seed = 1 + u64::from(index / 4);
        row.repetition = 0;
        row.makespan_s = Some(about(f64::from(row.spp), index));
        let mse = about(1.0 / f64::from(row.spp), 3 * index + 1);
        (row.mse, row.rmse) = (Some(mse), Some(mse.sqrt()));
    });
    both_ways(&points, "statistic = \"exponent\"\nx = \"spp\"\ny = \"makespan_s\"", [0.99, 1.01]);
    both_ways(&points, "statistic = \"rmse-slope\"", [-0.51, -0.49]);
}

#[test]
fn means_ranks_and_checksums() {
    let all = rows(20, |index, row| {
        row.seed = 1 + u64::from(index / 2);
        row.repetition = 0;
        row.estimator = if index % 2 == 0 { "bsdf" } else { "mis" }.to_string();
        row.mean_radiance = Some(if index % 2 == 0 { about(1.0, index) } else { about(1.0, index / 2) });
        row.checksum = format!("{index}");
    });
    let pair = "column = \"mean_radiance\"\nrows = { estimator = \"bsdf\" }\nover = { estimator = \"mis\" }";
    both_ways(&all, &format!("statistic = \"mean-ratio\"\n{pair}"), [0.99, 1.01]);
    let shifted = rows(20, |index, row| {
        *row = all[index as usize].clone();
        row.mean_radiance = row.mean_radiance.map(|mean| if index % 2 == 0 { mean + 0.1 } else { mean });
    });
    assert_eq!(
        verdict(&shifted, &format!("statistic = \"mean-ratio\"\n{pair}\nwithin = [0.99, 1.01]")).0,
        Verdict::Refuted
    );

    let ranked = rows(12, |index, row| {
        row.scene = format!("scene {index}");
        (row.rays, row.mse) = (Some(u64::from(index)), Some(f64::from(index * index)));
    });
    let rank = "statistic = \"rank-correlation\"\nx = \"rays\"\ny = \"mse\"\nby = \"scene\"";
    assert_eq!(verdict(&ranked, &format!("{rank}\nat-least = 0.9")).0, Verdict::Confirmed);
    assert_eq!(verdict(&ranked, &format!("{rank}\nat-most = 0.0")).0, Verdict::Refuted);

    let alike = rows(3, |_, row| row.checksum = "same".to_string());
    let mut other = alike.clone();
    other[1].checksum = "other".to_string();
    let checksum = "statistic = \"checksum\"\nwithin = [1, 1]";
    assert_eq!(verdict(&alike, checksum).0, Verdict::Confirmed);
    assert_eq!(verdict(&other, checksum).0, Verdict::Refuted);
    assert_eq!(verdict(&alike[..1], checksum).0, Verdict::NotAnswered, "nothing to compare with");
}

#[test]
fn other_conditions_are_told_with_their_factor() {
    let rows = rows(9, |index, row| row.makespan_s = Some(about(2.0, index)));
    let test = "statistic = \"value\"\ncolumn = \"makespan_s\"\nat-least = 1.0\ncomparable-if = { width = 1024, height = 768 }";
    let (found, why) = verdict(&rows, test);
    assert_eq!(found, Verdict::NotComparable);
    assert_eq!(why, "height = 6 instead of 768; width = 8 instead of 1024; 1/16384 of the pixels");
    let (found, why) = verdict(&rows, &format!("{test}\na-fortiori = true"));
    assert_eq!((found, why.is_empty()), (Verdict::Confirmed, false));
    let met = test.replace("1024", "\">=8\"").replace("768", "[6, 768]");
    assert_eq!(verdict(&rows, &met), (Verdict::Confirmed, String::new()));
}

#[test]
fn rows_that_are_not_there_answer_nothing() {
    let value = "statistic = \"value\"\ncolumn = \"makespan_s\"\nat-least = 1.0";
    assert_eq!(verdict(&rows(9, |_, _| ()), &format!("{value}\nrows = {{ scene = \"sky\" }}")).0, Verdict::NotAnswered);
    let out = folder_of(&[], "", rows(9, |_, _| ()));
    let text = claim(&format!("experiment = \"another\"\nlevel = 0.95\n{value}"));
    let reports = [Report::from_text("X.toml", &text).unwrap()];
    let answers = judge(&Lab::built_in(), &reports, &[out.path().to_path_buf()]).unwrap();
    assert_eq!(answers[0].verdict, Verdict::NotAnswered);
    assert!(!answers[0].is_unexpected());
}

fn refused(evidence: &str) -> String {
    match Report::from_text("X.toml", &claim(evidence)) {
        Err(Error::Input(error)) => error.to_string(),
        other => panic!("accepted: {other:?}"),
    }
}

#[test]
fn everything_a_claim_asks_for_exists() {
    let rows = "experiment = \"e\"\nrows = { scene = \"cornell\" }\nlevel = 0.95\nat-least = 1.0";
    for (evidence, told) in [
        (format!("statistic = \"mode\"\n{rows}"), vec!["X.toml:13", "mode", "rank-correlation"]),
        (format!("statistic = \"value\"\n{rows}"), vec!["X.toml:13", "column"]),
        (format!("statistic = \"value\"\ncolumn = \"seconds\"\n{rows}"), vec!["X.toml:14", "seconds", "makespan_s"]),
        (format!("statistic = \"checksum\"\nx = \"spp\"\n{rows}"), vec!["X.toml:14", "field = x"]),
        (format!("statistic = \"checksum\"\n{}", rows.replace("level = 0.95\n", "")), vec!["X.toml:5", "level"]),
        (format!("statistic = \"checksum\"\n{}", rows.replace("0.95", "95")), vec!["X.toml:16", "95"]),
        (format!("statistic = \"checksum\"\n{}", rows.replace("at-least = 1.0", "")), vec!["X.toml:5", "within"]),
        (format!("statistic = \"checksum\"\nwithin = [1, 2]\n{rows}"), vec!["X.toml:5", "at-most"]),
        (format!("statistic = \"checksum\"\n{}", rows.replace("scene", "szene")), vec!["szene", "scene_hash"]),
        ("statistic = \"case\"\nids = []\nlevel = 0.95\nat-most = 0.0".to_string(), vec!["X.toml:14", "hard case"]),
        (
            format!("statistic = \"forecast\"\nstrategy = \"s\"\ncores = \"many\"\ncolumn = \"speedup\"\n{rows}"),
            vec!["X.toml:15", "cores", "many"],
        ),
        (
            format!("statistic = \"mean-ratio\"\nover = {{ colour = 1 }}\ncolumn = \"mse\"\n{rows}"),
            vec!["X.toml:14", "over", "colour", "spp"],
        ),
        (
            format!(
                "statistic = \"count\"\ncolumn = \"spp\"\nrows = 3\n{}",
                rows.replace("rows = { scene = \"cornell\" }\n", "")
            ),
            vec!["X.toml:15", "rows", "3"],
        ),
        (
            "statistic = \"case\"\nids = [\"a\"]\nexperiment = \"e\"\nat-most = 0.0".to_string(),
            vec!["X.toml:15", "field = experiment", "ids"],
        ),
        (
            "statistic = \"guard\"\nguard = \"g\"\ncolumn = \"price\"".to_string(),
            vec!["X.toml:15", "price", "time_ratio"],
        ),
        (String::new(), vec!["X.toml:5", "context"]),
        ("context = \"c\"\nnot-comparable = \"n\"".to_string(), vec!["X.toml:5", "not-comparable"]),
        (format!("statistic = \"checksum\"\n{rows}\ncontext = \"c\""), vec!["X.toml:5", "missing"]),
        ("context = \"c\"\nexpectd = 1".to_string(), vec!["X.toml:14", "expectd"]),
    ] {
        let error = refused(&evidence);
        assert!(told.iter().all(|word| error.contains(word)), "{evidence}\n{error}");
    }
}

/// The excerpts of the reports that contain the quotes.
const EXCERPTS: [(&str, &str); 4] = [
    ("A", include_str!("../../../../experiments/claims/excerpts/A.txt")),
    ("B", include_str!("../../../../experiments/claims/excerpts/B.txt")),
    ("C", include_str!("../../../../experiments/claims/excerpts/C.txt")),
    ("D", include_str!("../../../../experiments/claims/excerpts/D.txt")),
];

#[test]
fn each_claim_appears_once_quotes_its_report_and_names_the_commit_that_fixed_it() {
    let reports = Report::all(&Lab::built_in()).unwrap();
    let mut ids: Vec<u32> = reports.iter().flat_map(|report| &report.claims).map(|claim| claim.id).collect();
    ids.sort_unstable();
    assert_eq!(ids, (1..=85).collect::<Vec<u32>>());
    for report in &reports {
        let (_, text) = EXCERPTS.iter().find(|(letter, _)| *letter == report.report).expect("excerpts of each report");
        for claim in &report.claims {
            assert!(text.contains(&claim.quote), "{}: {}", claim.id, claim.quote);
            assert!(claim.fixed().contains("Z in commit "), "{}: {}", claim.id, claim.fixed());
        }
    }
}

/// Every change of a claim is told to readers.
#[test]
fn changes_are_listed_in_the_documentation() {
    let text = include_str!("../../../../docs/reports.md");
    let reports = Report::all(&Lab::built_in()).unwrap();
    let changed = reports.iter().flat_map(|report| &report.claims).filter(|claim| !claim.changed.is_empty());
    let listed = |id: u32| text.contains(&format!("* **Claim {id}**:")) || is_in_list(text, id);
    let missing: Vec<u32> = changed.map(|claim| claim.id).filter(|id| !listed(*id)).collect();
    assert_eq!(missing, Vec::<u32>::new());
}

/// Whether the line of new claims names this one.
fn is_in_list(text: &str, id: u32) -> bool {
    let list = text.split_once("* **New claims**: ").map_or("", |(_, list)| list);
    let list = list.split_once('.').map_or("", |(list, _)| list).replace(" and ", ", ");
    list.split(|c: char| c == ',' || c.is_whitespace()).any(|number| number.parse() == Ok(id))
}

/// Every query matches rows that a sweep of the quick profile or of the reports' profile will write, and some of them have
/// partners.
#[test]
fn each_query_asks_for_rows_of_an_experiment() {
    let lab = Lab::built_in();
    let reports = Report::all(&Lab::built_in()).unwrap();
    let (mut rows, mut unmet): (BTreeMap<String, Vec<Columns>>, Vec<String>) = (BTreeMap::new(), Vec::new());
    for claim in reports.iter().flat_map(|report| &report.claims) {
        let Ok(Test { statistic: Statistic::OfRows { experiment, rows: wanted, kind, .. }, .. }) = claim.test() else {
            continue;
        };
        // An experiment has no cells if the program lacks the feature that it needs.
        if Definition::load(&lab, experiment).unwrap().missing_feature().is_some() {
            continue;
        }
        let own = rows.entry(experiment.clone()).or_insert_with(|| cells(&lab, experiment));
        let other = match kind {
            Kind::PairedRatio { over, .. } | Kind::Speedup { over, .. } | Kind::MeanRatio { over, .. } => Some(over),
            _ => None,
        };
        if let Some(over) = other.filter(|_| !matches!(kind, Kind::MeanRatio { .. })) {
            let shared = identity(wanted, over, &[]);
            let keys = |conditions: &Conditions| -> BTreeSet<Vec<String>> {
                let rows = own.iter().filter(|row| conditions.admit(row));
                rows.map(|row| shared.iter().map(|column| text(row, column)).collect()).collect()
            };
            if keys(wanted).is_disjoint(&keys(over)) {
                unmet.push(format!("{}: {experiment} where {wanted} beside {over}", claim.id));
            }
        }
        for conditions in std::iter::once(wanted).chain(other) {
            if !own.iter().any(|row| conditions.admit(row)) {
                unmet.push(format!("{}: {experiment} where {conditions}", claim.id));
            }
        }
    }
    assert_eq!(unmet, Vec::<String>::new());
}

/// The rows that an experiment's cells will have, before they run.
fn cells(lab: &Arc<Lab>, experiment: &str) -> Vec<Columns> {
    let definition = Definition::load(lab, experiment).unwrap();
    let profiles = [Profile::Quick, Profile::Reports].into_iter().filter(|profile| definition.has(*profile));
    let cells = profiles.flat_map(|profile| definition.cells(profile).unwrap());
    let row = |cell: Cell| {
        let setup = lab.prepare(cell.settings).unwrap();
        cell.points.iter().map(|point| columns(&Record { spp: point.spp, ..Record::of(&setup) })).collect::<Vec<_>>()
    };
    cells.filter(|cell| cell.external.is_none()).flat_map(row).collect()
}

/// Where noise decides, two verdicts are expected; any other is unexpected.
#[test]
fn a_number_near_the_limit_may_have_either_verdict() {
    let evidence =
        "experiment = \"an-experiment\"\nlevel = 0.95\nstatistic = \"value\"\ncolumn = \"makespan_s\"\nat-least = 1e-9";
    let out = folder_of(&[], "", rows(9, |_, _| ()));
    let surprises = |expected: &str| {
        let text = claim(evidence).replace("\"confirmed\"", &format!("\"{expected}\""));
        let reports = [Report::from_text("X.toml", &text).unwrap()];
        judge(&Lab::built_in(), &reports, &[out.path().to_path_buf()]).unwrap()[0].is_unexpected()
    };
    assert!(!surprises("confirmed") && !surprises("open or confirmed"));
    assert!(surprises("open") && surprises("open or refuted"));
    let wrong = claim(evidence).replace("\"confirmed\"", "\"open or so\"");
    assert!(Report::from_text("X.toml", &wrong).unwrap_err().to_string().contains("open or so"));
}

/// Rows that were measured before the claim was fixed judge nothing: its bound may have been chosen by them.
#[test]
fn a_bound_younger_than_its_rows_is_told() {
    let age = |first: &str, last: &str| {
        let times = rows(9, |index, row| {
            row.started_utc = if index == 0 { first } else { last }.to_string();
        });
        let out = folder_of(&[], "", times);
        let text = claim(&format!("experiment = \"an-experiment\"\nlevel = 0.95\n{SECONDS}\nat-most = 9.0"));
        let reports = [Report::from_text("X.toml", &text).unwrap()];
        let answers = judge(&Lab::built_in(), &reports, &[out.path().to_path_buf()]).unwrap();
        (answers[0].verdict, answers[0].is_bound_younger(), answers[0].age)
    };
    let after = "2026-01-01T00:00:01Z";
    assert_eq!(age(after, after), (Verdict::Confirmed, false, Age::BoundFirst));
    assert_eq!(age("2025-12-31T23:59:59Z", after), (Verdict::Confirmed, true, Age::RowsFirst));
    assert_eq!(age("", after), (Verdict::Confirmed, true, Age::Unknown));
    assert_eq!(age("zzz", after), (Verdict::Confirmed, true, Age::Unknown));
    for wrong in ["2026-01-01", "2026-01-01T00:00:00+01:00", "soon 0123abcd", "2026-99-99T99:99:99Z"] {
        let text = claim("context = \"c\"").replace("2026-01-01T00:00:00Z", wrong);
        let error = Report::from_text("X.toml", &text).unwrap_err().to_string();
        assert!(error.contains("frozen") && error.contains("0123abcd") && error.contains("X.toml:11"), "{error}");
    }
    let without =
        claim(&format!("experiment = \"e\"\nlevel = 0.95\n{SECONDS}\nat-most = 9.0")).replace("reason = \"w\"", "");
    assert!(Report::from_text("X.toml", &without).unwrap_err().to_string().contains("no reason"));
}

/// Hard cases and the price list of the guards judge claims in both directions; of several folders the hull of the intervals does.
#[test]
fn cases_and_guards_judge_both_ways() {
    let folder = |failed: usize, error: f64| {
        let out = tempfile::tempdir().unwrap();
        let case = |id: &str, failed: usize| CaseRow {
            id: id.to_string(),
            tries: String::new(),
            pass: failed == 0,
            trials: 2,
            failed,
            variant: String::new(),
            expected: String::new(),
            found: String::new(),
            skipped: String::new(),
        };
        cases_file::write(out.path(), &[case("C1", 0), case("C2", failed)]).unwrap();
        let prices = out.path().join(guard_prices::FOLDER);
        std::fs::create_dir(&prices).unwrap();
        // A file of the first version, which has fewer columns.
        let head = "guard,error,with,without,error_with,error_with_low,error_with_high,error_without,error_without_low,\
                    error_without_high,operation,ns_with,ns_without,time_ratio,time_ratio_low,time_ratio_high";
        let text = format!("{head}\ng,,,,{error},{},{},1,1,1,,,,,,\n", 0.9 * error, 1.1 * error);
        std::fs::write(prices.join(guard_prices::FILE), text).unwrap();
        out
    };
    let of = |folders: &[&tempfile::TempDir], evidence: &str| {
        let reports = [Report::from_text("X.toml", &claim(&format!("level = 0.95\n{evidence}"))).unwrap()];
        let paths: Vec<_> = folders.iter().map(|folder| folder.path().to_path_buf()).collect();
        let answer = judge(&Lab::built_in(), &reports, &paths).unwrap().remove(0);
        (answer.verdict, answer.found.map_or(0, |found| found.units))
    };
    let (good, bad) = (folder(0, 1e-3), folder(1, 1.0));
    let cases = "statistic = \"case\"\nids = [\"C1\", \"C2\"]\nwithin = [0, 0]";
    assert_eq!((of(&[&good], cases), of(&[&bad], cases)), ((Verdict::Confirmed, 2), (Verdict::Refuted, 2)));
    assert_eq!(of(&[&good, &bad], cases), (Verdict::Open, 2));
    assert_eq!(of(&[&good], &cases.replace("C2", "C3")).0, Verdict::NotAnswered);
    let guard = "statistic = \"guard\"\nguard = \"g\"\ncolumn = \"error_with\"\nat-most = 0.1";
    assert_eq!((of(&[&good], guard).0, of(&[&bad], guard).0), (Verdict::Confirmed, Verdict::Refuted));
    assert_eq!(of(&[&bad, &good], guard).0, Verdict::Open);
    assert_eq!(of(&[&good], &guard.replace("error_with", "time_ratio")).0, Verdict::NotAnswered, "not timed");
}
