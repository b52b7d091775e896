//! Ledgers on rows of other programs.

use super::*;
use crate::error::Error;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;

/// A ledger on `sorts.csv`, with one claim.
pub(super) fn ledger(evidence: &str) -> String {
    format!(
        "report = \"S\"\ntitle = \"Sorting\"\nabout = \"Who.\"\nsource = \"A. Author, 2026\"\ndoi = \"10.1/2\"\n\
         [[table]]\nname = \"sorts\"\nfile = \"sorts.csv\"\nsettings = [\"program\", \"n\"]\nvalues = [\"seconds\"]\n\
         [[claim]]\nid = 1\nquote = \"q\"\nplace = \"p\"\nreported = \"r\"\nclaim = \"c\"\nexpected = \"confirmed\"\n\
         frozen = \"2026-01-01T00:00:00Z\"\nreason = \"w\"\nlevel = 0.95\nexperiment = \"sorts\"\n{evidence}\n"
    )
}

/// `quick` takes n ns, `bubble` n² ns; repetitions differ by a per mille.
pub(super) fn sorts() -> String {
    let mut text = "n,repetition,program,seconds,remark\n".to_string();
    for repetition in 0..7 {
        for n in [100.0, 1000.0, 10000.0] {
            let noise = 1e-9 * (1.0 + 0.001 * f64::from(repetition));
            let _ = writeln!(text, "{n},{repetition},quick,{},\"a, b\"", n * noise);
            let _ = writeln!(text, "{n},{repetition},bubble,{},", n * n * noise);
        }
    }
    text
}

pub(super) fn folder(rows: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("sorts.csv"), rows).unwrap();
    folder
}

fn judged(rows: &str, evidence: &str) -> std::result::Result<(Verdict, Option<f64>, String), String> {
    let folder = folder(rows);
    let reports = [Report::from_text("s.toml", &ledger(evidence)).map_err(|error| error.to_string())?];
    let out: [PathBuf; 1] = [folder.path().to_path_buf()];
    let answers = judge(&Lab::built_in(), &reports, &out).map_err(|error| match error {
        Error::Input(error) => error.to_string(),
        other => panic!("{other}"),
    })?;
    let source = answers[0].source().unwrap_or_default();
    Ok((answers[0].verdict, answers[0].found.map(|found| found.value), source))
}

/// Closed forms: bubble over quick at n = 1000 is 1000, and the times grow by the powers 1 and 2.
#[test]
fn rows_of_other_programs_judge_both_ways() {
    let ratio = "statistic = \"paired-ratio\"\ncolumn = \"seconds\"\nrows = { program = \"bubble\", n = 1000 }\nover = { program = \"quick\", n = 1000 }";
    let speedup = "statistic = \"speedup\"\ncolumn = \"seconds\"\nrows = { program = \"quick\" }\nover = { program = \"bubble\" }";
    let power = |program: &str| {
        format!("statistic = \"exponent\"\nx = \"n\"\ny = \"seconds\"\nrows = {{ program = \"{program}\" }}")
    };
    for (evidence, expected) in [
        (ratio.to_string(), 1000.0),
        // Geometric mean of 100, 1000 and 10000: partners agree in n.
        (speedup.to_string(), 1000.0),
        (power("quick"), 1.0),
        (power("bubble"), 2.0),
        // n = 1000 and 10000 of 7 repetitions in the median.
        (
            "statistic = \"value\"\ncolumn = \"seconds\"\nrows = { program = \"quick\", n = \">=1000\" }".to_string(),
            5.5165e-6,
        ),
    ] {
        let with = |low: f64, high: f64| judged(&sorts(), &format!("{evidence}\nwithin = [{low}, {high}]")).unwrap();
        let (verdict, found, source) = with(0.9 * expected, 1.1 * expected);
        assert_eq!(verdict, Verdict::Confirmed, "{evidence} {found:?}");
        assert!((found.unwrap() / expected - 1.0).abs() < 1e-9, "{evidence} {found:?}");
        assert!(source.ends_with("sorts.csv"), "{source}");
        assert_eq!(with(1.1 * expected, 1.2 * expected).0, Verdict::Refuted, "{evidence}");
    }
}

/// The rows with another column.
fn with_column(name: &str, value: &str) -> String {
    let rows = sorts();
    let (head, rest) = rows.split_once('\n').unwrap();
    format!("{name},{head}\n{}", rest.lines().flat_map(|line| [value, ",", line, "\n"]).collect::<String>())
}

/// A time tells whether a bound is older, a seed may be as large as a word, and both may be missing.
#[test]
fn seeds_and_times_are_read() {
    let value = "statistic = \"value\"\ncolumn = \"seconds\"\nat-least = 0.0";
    let is_younger = |rows: &str| {
        let own = folder(rows);
        let reports = [Report::from_text("s.toml", &ledger(value)).unwrap()];
        judge(&Lab::built_in(), &reports, &[own.path().to_path_buf()]).unwrap()[0].is_bound_younger()
    };
    assert!(!is_younger(&with_column("started_utc", "2026-01-01T00:00:00Z")));
    assert!(is_younger(&with_column("started_utc", "2025-12-31T23:59:59Z")));
    assert!(is_younger(&with_column("started_utc", "")) && is_younger(&sorts()));
    let last = u64::MAX.to_string();
    assert!(judged(&with_column("seed", &last), &format!("{value}\nrows = {{ seed = [\"{last}\"] }}")).is_ok());
    assert!(judged(&with_column("seed", ""), value).is_ok());
}

#[test]
fn wrong_tables_and_queries_are_told_with_their_place() {
    let value = "statistic = \"value\"\ncolumn = \"seconds\"\nat-least = 0.0";
    for (evidence, told) in [
        (value.replace("seconds", "makespan_s"), ["s.toml:23", "makespan_s", "seconds, repetition"]),
        (format!("{value}\nrows = {{ size = 3 }}"), ["s.toml:25", "size", "program"]),
        (format!("{value}\ncomparable-if = {{ machine = \"a\" }}"), ["s.toml:25", "machine", "program"]),
        ("statistic = \"rmse-slope\"\nat-least = 0.0".to_string(), ["s.toml:21", "sorts", "paired-ratio"]),
        (
            "statistic = \"speedup\"\nover = { program = \"quick\" }\nat-least = 0.0".to_string(),
            ["s.toml:21", "sorts", "column"],
        ),
    ] {
        let error = judged(&sorts(), &evidence).unwrap_err();
        assert!(told.iter().all(|word| error.contains(word)), "{evidence}\n{error}");
    }
    for (rows, told) in [
        (sorts().replacen("seconds", "s", 1), ["sorts.csv:1", "seconds", "remark"]),
        (sorts().replacen("100,0,quick,", "100,0,quick,x", 1), ["sorts.csv:2", "seconds", "finite"]),
        (sorts().replacen("100,0,quick,", "100,-1,quick,", 1), ["sorts.csv:2", "repetition", "-1"]),
        (sorts().replacen("100,0,bubble", "100,0,quick", 1), ["sorts.csv:3", "n=100", "settings"]),
        (sorts().replacen("100,0,quick,", "100,0,", 1), ["sorts.csv:2", "cannot be read", "fields"]),
        (with_column("seed", "-1"), ["sorts.csv:2", "seed = -1", "0 to 18446744073709551615"]),
        (with_column("pair", "4294967296"), ["sorts.csv:2", "pair = 4294967296", "0 to 4294967295"]),
        (with_column("started_utc", "zzz"), ["sorts.csv:2", "started_utc = zzz", "such as 2026-01-31T12:00:00Z"]),
        (with_column("started_utc", "2026-11-28 05:00:00"), ["sorts.csv:2", "started_utc = 2026", "a time in UTC"]),
        (with_column("started_utc", "9999-99-99T99:99:99Z"), ["sorts.csv:2", "started_utc = 9999", "a time in UTC"]),
    ] {
        let error = judged(&rows, value).unwrap_err();
        assert!(told.iter().all(|word| error.contains(word)), "{error}");
    }
    let twice = ledger(value).replace("[\"seconds\"]", "[\"n\"]");
    let error = Report::from_text("s.toml", &twice).unwrap_err().to_string();
    assert!(error.contains("s.toml:") && error.contains("named twice"), "{error}");
}

/// A folder without the file answers nothing; an empty field was not measured.
#[test]
fn rows_that_are_not_there_are_no_values() {
    let value = "statistic = \"value\"\ncolumn = \"seconds\"\nrows = { program = \"quick\", n = 100 }\nat-least = 0.0";
    let reports = [Report::from_text("s.toml", &ledger(value)).unwrap()];
    let empty = tempfile::tempdir().unwrap();
    let answers = judge(&Lab::built_in(), &reports, &[empty.path().to_path_buf()]).unwrap();
    assert_eq!(answers[0].verdict, Verdict::NotAnswered);
    let rows = "program,n,repetition,seconds\nquick,100,0,1.0\nquick,100,1,\nquick,100,2,3.0\n";
    assert_eq!(judged(rows, value).unwrap().1, Some(2.0));
    let text = Listing::of_ledgers(&PathBuf::from("s.toml"), &reports).markdown_of(&answers, empty.path());
    assert!(text.starts_with("# Sorting\n") && text.contains("A. Author, 2026, <https://doi.org/10.1/2>"), "{text}");
}

/// Ledgers that a program adds take the place of the four reports; their numbers and names are unique, too.
#[test]
fn a_program_judges_its_own_ledgers() {
    let value = "statistic = \"value\"\ncolumn = \"seconds\"\nrows = { program = \"quick\", n = 100 }\nat-least = 0.0";
    let lab =
        |texts: &[(&str, String)]| Arc::new(texts.iter().fold(Lab::new(), |lab, (name, text)| lab.claims(name, text)));
    let mine = lab(&[("mine", ledger(value))]);
    let reports = Report::all(&mine).unwrap();
    let folder = folder(&sorts());
    let answers = judge(&mine, &reports, &[folder.path().to_path_buf()]).unwrap();
    assert_eq!((answers.len(), answers[0].report.title.as_str()), (1, "Sorting"));
    assert_eq!(answers[0].verdict, Verdict::Confirmed);
    assert!(section(&mine, folder.path()).unwrap().is_some());
    for (other, told) in [
        (ledger(value).replace("\"S\"", "\"R\""), "claims/other.toml:12:6: id = 1: "),
        (ledger(value).replace("id = 1\n", "id = 2\n"), "claims/other.toml:1:10: report = S: "),
    ] {
        let error = Report::all(&lab(&[("mine", ledger(value)), ("other", other)])).unwrap_err().to_string();
        assert!(error.starts_with(told), "{error}");
    }
}

#[test]
fn resources_of_tables_are_told_and_checked() {
    let value = "statistic = \"value\"\ncolumn = \"seconds\"\nat-least = 0.0";
    let with = |fields: &str| {
        let text = ledger(value).replace("values = [\"seconds\"]\n", &format!("values = [\"seconds\"]\n{fields}\n"));
        Report::from_text("s.toml", &text)
    };
    let report = with("command = \"sh m.sh\"\nseconds = 12.4\nbytes = 1500000\nmachine = \"a Cray-1\"").unwrap();
    let Needs::Table(table) = report.needs(&report.claims[0]) else { panic!() };
    assert_eq!((table.command.as_deref(), table.costs().as_str()), (Some("sh m.sh"), "12 s, 1.5 MB, on a Cray-1"));
    for (field, told) in [
        ("seconds = -1.0", "s.toml:11:11: seconds = -1: is no time"),
        ("seconds = nan", "s.toml:11:"),
        ("bytes = -1", "s.toml:11:"),
        ("command = \"\"", "s.toml:11:1: command: is empty"),
        ("machine = \"a\\nb\"", "s.toml:11:"),
        ("minutes = 3", "s.toml:11:"),
    ] {
        let error = with(field).unwrap_err().to_string();
        assert!(error.starts_with(told), "{field}: {error}");
    }
}
