//! Cells that run side by side: `[[compare]]`, and the two builds of `--baseline`.

use crate::diff::{json, run};
use crate::experiment::{TINY, write_tiny};
use assert_cmd::cargo::cargo_bin;
use pathmark::measure::COLUMNS;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A row's cell, process, pair, place and position in the sweep.
type Run = (String, u32, Option<u32>, Option<u32>, u64);

fn rows(folder: &Path) -> Vec<Run> {
    let mut reader = csv::Reader::from_path(folder.join("records.csv")).unwrap();
    let heads = reader.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let columns = ["cell", "repetition", "pair", "place", "run_order"].map(column);
    let run = |row: csv::StringRecord| {
        let [cell, process, pair, place, order] = columns.map(|at| row[at].to_string());
        (cell, process.parse().unwrap(), pair.parse().ok(), place.parse().ok(), order.parse().unwrap())
    };
    reader.records().map(|row| run(row.unwrap())).collect()
}

/// Whether a line of `records.csv` is a row in pairs of this process.
fn rows_of_process(line: &str, process: u32) -> bool {
    let head = COLUMNS.iter().position(|column| column.name == "repetition").unwrap();
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
    let row = reader.records().next().unwrap().unwrap();
    row[head] == process.to_string() && !row[head + 1].is_empty()
}

fn compared(with: &str) -> String {
    let compare = format!("[[compare]]\nwhat = {{ threads = [2] }}\n{with}\n\n[matrix]");
    TINY.replace("[matrix]", &compare).replace("repetitions = 3", "repetitions = 3\npairs = 2")
}

/// Two cells on two threads are compared with the serial run: three processes of two pairs, whose order is reversed. The
/// two cells on one thread run alone.
#[test]
fn compared_cells_run_in_turns() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &compared("with = { strategy = [\"serial\"] }\ngoal = \"0.0001 %\""));
    let finished = run(folder.path(), &["run", "tiny.toml"], 0);
    assert!(finished.err.contains("2 of 2 comparisons missed their precision"), "{}", finished.err);
    let rows = rows(&folder.path().join("out/tiny"));
    let (alone, paired): (Vec<&Run>, Vec<&Run>) = rows.iter().partition(|run| run.2.is_none());
    assert_eq!((alone.len(), paired.len()), (6, 18));
    let orders: BTreeSet<u64> = rows.iter().map(|run| run.4).collect();
    assert_eq!(orders, (0..24).collect());
    for process in 0..3 {
        let of_pair = |pair: u32| {
            let mut runs: Vec<&&Run> = paired.iter().filter(|run| (run.1, run.2) == (process, Some(pair))).collect();
            runs.sort_by_key(|run| run.4);
            assert!(runs.iter().zip(0..).all(|(run, place)| run.3 == Some(place)));
            assert!(runs.windows(2).all(|two| two[1].4 == two[0].4 + 1), "{runs:?}");
            runs.into_iter().map(|run| run.0.clone()).collect::<Vec<_>>()
        };
        let [first, mut second] = [of_pair(0), of_pair(1)];
        second.reverse();
        assert_eq!((first.len(), &first), (3, &second));
    }
    // A complete sweep has nothing to resume; the ranking needs three processes, which it has.
    run(folder.path(), &["run", "tiny.toml", "--resume"], 0);
    assert_eq!(self::rows(&folder.path().join("out/tiny")).len(), 24);
    let ranked = json(&run(folder.path(), &["rank", "out/tiny", "--json"], 0));
    assert!(ranked.to_string().contains("\"repetitions\":3"), "{ranked}");
    assert_eq!(ranked["least_repetitions"], 3);
    let told = run(folder.path(), &["rank", "out/tiny"], 0).err;
    assert!(!told.contains("cannot tell any two schedules apart"), "{told}");
    // The page draws speedups from both kinds of rows.
    let figure = fs::read_to_string(folder.path().join("out/tiny/figures/speedup.svg")).unwrap();
    assert!(figure.contains("work-stealing"), "{figure}");
}

/// Comparisons that missed their goal have as many processes as the profile allows; other cells have those of the first
/// stage. Where the goal is reached, or the command sets the repetitions, there is no second stage.
#[test]
fn comparisons_that_missed_their_goal_get_more_processes() {
    let goal = |goal: &str, most: &str| {
        let stages = format!("repetitions = {{ at-least = 3, {most} }}");
        compared(&format!("with = {{ strategy = [\"serial\"] }}\n{goal}")).replace("repetitions = 3", &stages)
    };
    let counts = |folder: &Path| {
        let rows = rows(&folder.join("out/tiny"));
        let processes = |paired: bool| -> BTreeSet<u32> {
            rows.iter().filter(|run| run.2.is_some() == paired).map(|run| run.1).collect()
        };
        [processes(false).len(), processes(true).len(), rows.len()]
    };
    let tiny = |text: &str| {
        let folder = tempfile::tempdir().unwrap();
        write_tiny(folder.path(), text);
        folder
    };
    let folder = tiny(&goal("goal = \"0.0001 %\"", "at-most = 5"));
    let said = run(folder.path(), &["run", "tiny.toml"], 0).err;
    assert!(said.contains("2 comparisons missed their precision in 3 processes and get more"), "{said}");
    assert_eq!(counts(folder.path()), [3, 5, 2 * 3 + 3 * 5 * 2]);
    // Nothing is left to do, and a process of the second stage that was lost is run again.
    let records = folder.path().join("out/tiny/records.csv");
    let whole = fs::read_to_string(&records).unwrap();
    run(folder.path(), &["run", "tiny.toml", "--resume"], 0);
    assert_eq!(fs::read_to_string(&records).unwrap(), whole);
    let kept = whole.split_inclusive('\n').enumerate().filter(|(line, row)| *line == 0 || !rows_of_process(row, 4));
    fs::write(&records, kept.map(|(_, row)| row).collect::<String>()).unwrap();
    assert_eq!(counts(folder.path()), [3, 4, 2 * 3 + 3 * 4 * 2]);
    run(folder.path(), &["run", "tiny.toml", "--resume"], 0);
    assert_eq!(counts(folder.path()), [3, 5, 2 * 3 + 3 * 5 * 2]);

    for (text, options, expected) in [
        (goal("goal = \"10000 %\"", "at-most = 5"), &[][..], [3, 3, 24]),
        (goal("goal = \"0.0001 %\"", "at-most = 5, max-time = \"1ms\""), &[], [3, 3, 24]),
        (goal("goal = \"0.0001 %\"", "at-most = 5"), &["--repetitions", "3"], [3, 3, 24]),
    ] {
        let folder = tiny(&text);
        run(folder.path(), &[&["run", "tiny.toml"], options].concat(), 0);
        assert_eq!(counts(folder.path()), expected, "{text}");
    }
    for (text, said) in [
        (goal("", "at-most = 5"), ["tiny.toml", "at-least", "none has a goal"]),
        (goal("goal = \"1 %\"", "at-most = 3"), ["tiny.toml", "at-most = 3", "more than at-least = 3"]),
    ] {
        let folder = tiny(&text);
        let refused = run(folder.path(), &["run", "tiny.toml"], 2);
        assert!(said.iter().all(|part| refused.err.contains(part)), "{}", refused.err);
        assert!(!folder.path().join("out").exists());
    }
}

/// A tiny image takes far less than 5 ms, so a row is the mean of several runs; a run outside of pairs is a row.
#[test]
fn short_runs_are_repeated_within_a_turn() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &compared("with = { strategy = [\"serial\"] }"));
    run(folder.path(), &["run", "tiny.toml"], 0);
    let mut reader = csv::Reader::from_path(folder.path().join("out/tiny/records.csv")).unwrap();
    let column = |name: &str| COLUMNS.iter().position(|column| column.name == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.unwrap()).collect();
    let of = |is_paired: bool| {
        let own = rows.iter().filter(move |row| row[column("pair")].is_empty() != is_paired);
        own.map(|row| row[column("runs")].parse::<u32>().ok()).collect::<Vec<_>>()
    };
    assert_eq!(of(false), [None; 6]);
    let paired = of(true);
    // A process that is interrupted at its start may think that its runs are long.
    assert!(paired.len() == 18 && paired.iter().all(Option::is_some) && paired.iter().any(|runs| *runs > Some(1)));
}

/// A process that lacks a cell's rows runs all of its cells again, in pairs of new numbers: rows of two times make no pair.
#[test]
fn a_resumed_process_makes_no_pairs_with_older_rows() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &compared("with = { strategy = [\"serial\"] }"));
    run(folder.path(), &["run", "tiny.toml"], 0);
    let path = folder.path().join("out/tiny/records.csv");
    let text = fs::read_to_string(&path).unwrap();
    let is_lost = |line: &str| line.contains("work-stealing/2t,") && rows_of_process(line, 1);
    let kept: Vec<&str> = text.lines().filter(|line| !is_lost(line)).collect();
    assert_eq!(text.lines().count(), kept.len() + 2);
    fs::write(&path, kept.join("\n") + "\n").unwrap();
    run(folder.path(), &["run", "tiny.toml", "--resume"], 0);
    let of_process: Vec<Run> =
        rows(&folder.path().join("out/tiny")).into_iter().filter(|run| run.1 == 1 && run.2.is_some()).collect();
    for pair in [2, 3] {
        assert_eq!(of_process.iter().filter(|run| run.2 == Some(pair)).count(), 3, "{of_process:?}");
    }
    let stealing = of_process.iter().filter(|run| run.0.ends_with("work-stealing/2t"));
    assert!(stealing.map(|run| run.2).eq([Some(2), Some(3)]), "{of_process:?}");
}

#[test]
fn filters_keep_what_a_cell_is_compared_with() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &compared("with = { strategy = [\"static-blocks\"], threads = [2] }"));
    run(folder.path(), &["run", "tiny.toml", "--filter", "strategy=work-stealing", "--filter", "threads=2"], 0);
    let cells: BTreeSet<String> = rows(&folder.path().join("out/tiny")).into_iter().map(|run| run.0).collect();
    assert!(cells.iter().any(|cell| cell.ends_with("static-blocks/2t")), "{cells:?}");
}

#[test]
fn two_builds_take_turns_in_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let one = TINY.replace("[1, 2]", "[1]").replace("\"static-blocks\", ", "").replace("= 3", "= 4\npairs = 2");
    write_tiny(folder.path(), &one);
    let program = cargo_bin!("pathmark").display().to_string();
    run(folder.path(), &["run", "tiny.toml", "--baseline", &program], 0);
    let [own, other] = ["out/tiny", "out/baseline/tiny"].map(|name| rows(&folder.path().join(name)));
    let turns = |rows: &[Run]| -> BTreeSet<(String, u32, Option<u32>)> {
        rows.iter().map(|(cell, process, pair, ..)| (cell.clone(), *process, *pair)).collect()
    };
    assert_eq!((own.len(), other.len()), (16, 16));
    assert_eq!(turns(&own), turns(&other));
    let found =
        json(&run(folder.path(), &["diff", "out/baseline/tiny", "out/tiny", "--json", "--fail-above", "900%"], 0));
    let text = found.to_string();
    assert!(text.contains("\"interval\":{"), "four processes give an interval: {text}");
}

#[test]
fn comparisons_of_nothing_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (with, told) in [
        ("with = { strategy = [\"rayon\"] }", "selects no two cells"),
        ("with = { stratgy = [\"serial\"] }", "stratgy"),
        ("with = { strategy = [\"serial\"] }\ngoal = \"-1 %\"", "-1%"),
        ("with = { strategy = \"serial\" }", "tiny.toml:"),
        ("what = {}", "with"),
    ] {
        let text = if with == "what = {}" { compared("").replace("threads = [2] }", "}") } else { compared(with) };
        write_tiny(folder.path(), &text);
        let finished = run(folder.path(), &["run", "tiny.toml"], 2);
        assert!(finished.err.contains(told) && finished.err.contains("tiny.toml"), "{}", finished.err);
        assert!(!folder.path().join("out").exists());
    }
}

/// `run --plan` runs a pilot, and writes nothing.
#[test]
fn a_plan_tells_what_pairs_reach() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &compared("with = { strategy = [\"serial\"] }"));
    let finished = run(folder.path(), &["run", "tiny.toml", "--plan"], 0);
    assert!(finished.out.contains("2 comparisons with") && finished.out.contains("1 %"), "{}", finished.out);
    assert!(!folder.path().join("out").exists());
}
