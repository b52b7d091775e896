//! `rank`: which schedules can be told apart?

use crate::diff::{base, json, measured, run, steady};
use crate::experiment::{TINY, write_tiny};
use crate::program::in_memory;
use serde_json::Value;
use std::fs;

/// Invented times of a cell: three times as long for serial runs, and twice for one thread.
fn times(cell: &str, repetition: u32) -> f64 {
    let factor = match cell {
        _ if cell.ends_with("serial/1t") => 3.0,
        _ if cell.ends_with("/1t") => 2.0,
        _ => 1.0,
    };
    factor * steady(if repetition.is_multiple_of(2) { cell } else { "" }, repetition)
}

#[test]
fn schedules_of_one_speed_share_a_group_and_others_do_not() {
    let folder = in_memory();
    base(folder.path());
    measured(folder.path(), "ranked", times);
    let found = json(&run(folder.path(), &["rank", "ranked", "--json"], 0));
    let places = found["images"][0]["places"].as_array().unwrap();
    let told: Vec<String> = places
        .iter()
        .map(|place| {
            let schedule = place["schedule"].as_str().unwrap();
            format!("{} {}", schedule.rsplit_once('/').unwrap().1, place["groups"])
        })
        .collect();
    assert_eq!(told, ["2t [0]", "2t [0]", "1t [1]", "1t [1]", "1t [2]"]);
    assert!(places[4]["schedule"].as_str().unwrap().contains("serial"), "{found}");
    // 5 schedules have 20 hypotheses: 2^-8 > .05 / 20 >= 2^-9.
    assert_eq!(found["least_repetitions"], 9);
    let [low, high] = ["low", "high"].map(|end| places[4]["interval"][end].as_f64().unwrap());
    assert!(low <= 3.0 + 1e-9 && high >= 3.0 - 1e-9 && high - low < 0.1, "{low} to {high}");
    let printed = run(folder.path(), &["rank", "ranked"], 0);
    assert!(
        printed.out.contains("time / first")
            && printed.out.contains("The place is decided by ")
            && printed.out.lines().any(|line| line.contains("  c ")),
        "{}",
        printed.out
    );
    assert!(!printed.err.contains("--repetitions"), "{}", printed.err);
    let markdown = run(folder.path(), &["rank", "ranked", "--markdown"], 0).out;
    assert!(
        markdown.contains("| time / first | interval | median | groups | schedule |\n|--:|--:|--:|--|--|\n"),
        "{markdown}"
    );
    assert_eq!(markdown.lines().filter(|line| line.starts_with("| ")).count(), 1 + 5, "{markdown}");
    let latex = run(folder.path(), &["rank", "ranked", "--latex"], 0);
    assert!(latex.out.contains("\\begin{tabular}{lrrrl}"), "{}", latex.out);
    assert!(latex.out.contains("/2t & 1.000 & ") && latex.out.contains(" & c \\\\\n"), "{}", latex.out);
}

#[test]
fn filters_leave_fewer_schedules_and_few_repetitions_tell_how_many_are_needed() {
    let folder = in_memory();
    base(folder.path());
    let two = json(&run(folder.path(), &["rank", "base/tiny", "--filter", "threads=2", "--json"], 0));
    assert_eq!(two["images"][0]["places"].as_array().unwrap().len(), 2);
    assert_eq!(two["least_repetitions"], 6);
    run(folder.path(), &["run", "tiny.toml", "--repetitions", "3", "--out", "few"], 0);
    let few = run(folder.path(), &["rank", "few/tiny"], 0);
    assert!(few.err.contains("3 repetitions") && few.err.contains("--repetitions 9"), "{}", few.err);
}

#[test]
fn folders_without_a_ranking_are_refused() {
    let folder = in_memory();
    base(folder.path());
    let refused = |arguments: &[&str], said: &str| {
        let finished = run(folder.path(), &[&["rank"], arguments].concat(), 2);
        assert!(finished.err.contains(said), "{said} is not in {}", finished.err);
    };
    refused(&["nowhere"], "nowhere");
    refused(&["base/tiny", "--filter", "threads=7"], "no image with two schedules");
    refused(&["base/tiny", "--filter", "mood=good"], "mood");
    fs::remove_file(folder.path().join("base/tiny/machine.toml")).unwrap();
    refused(&["base/tiny"], "machine.toml");
}

/// Two parts of a sweep have no repetition in common, so each is ranked apart. Each schedule is in the part that ran it,
/// and the serial run in both.
#[test]
fn parts_of_a_sweep_are_ranked_apart_and_list_every_schedule() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    for (shard, out) in [("1/2", "a"), ("2/2", "b")] {
        run(folder.path(), &["run", "tiny.toml", "--shard", shard, "--repetitions", "9", "--out", out], 0);
    }
    run(folder.path(), &["merge", "a", "b", "-o", "merged"], 0);
    let found = json(&run(folder.path(), &["rank", "merged/tiny", "--json"], 0));
    let parts = found["images"].as_array().unwrap();
    let schedules = |part: &Value| -> Vec<String> {
        let places = part["places"].as_array().unwrap();
        places.iter().map(|place| place["schedule"].as_str().unwrap().to_string()).collect()
    };
    assert_eq!(parts.iter().map(|part| part["part"].to_string()).collect::<Vec<_>>(), ["[1,2]", "[2,2]"]);
    let mut all: Vec<String> = parts.iter().flat_map(schedules).collect();
    all.sort();
    let expected =
        ["serial/1t", "serial/1t", "static-blocks/1t", "static-blocks/2t", "work-stealing/1t", "work-stealing/2t"];
    assert_eq!(all, expected.map(|schedule| format!("tiles:8x8/{schedule}")));
    let has_ratio = |place: &Value| place["ratio"].is_f64() && place["repetitions"] == 9;
    assert!(parts.iter().all(|part| part["places"].as_array().unwrap().iter().all(has_ratio)), "{found}");
    let printed = run(folder.path(), &["rank", "merged/tiny"], 0);
    assert!(
        printed.out.contains(", part 2 of 2\n") && printed.err.contains("each part is ranked apart"),
        "{}",
        printed.err
    );
}

/// A schedule whose rows failed is not ranked, but named.
#[test]
fn schedules_that_failed_are_named() {
    let folder = in_memory();
    base(folder.path());
    let path = folder.path().join("old/records.csv");
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let heads = reader.headers().unwrap().clone();
    let at = |name: &str| heads.iter().position(|head| head == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let mut writer = csv::Writer::from_path(&path).unwrap();
    writer.write_record(&heads).unwrap();
    for row in rows {
        let is_failed = &row[at("strategy")] == "static-blocks" && &row[at("threads")] == "2";
        let error = |(place, value)| if is_failed && place == at("error") { "it broke" } else { value };
        writer.write_record(row.iter().enumerate().map(error)).unwrap();
    }
    drop(writer);
    let found = run(folder.path(), &["rank", "old"], 0);
    assert!(found.err.contains("1 cell not ranked") && found.err.contains("static-blocks/2t"), "{}", found.err);
}
