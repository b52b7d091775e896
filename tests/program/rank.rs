//! `rank`: which schedules can be told apart?

use crate::diff::{base, json, measured, run, steady};
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
    let folder = tempfile::tempdir().unwrap();
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
    assert!(printed.out.contains("ratio") && printed.out.lines().any(|line| line.contains("  c ")), "{}", printed.out);
    assert!(!printed.err.contains("--repetitions"), "{}", printed.err);
}

#[test]
fn filters_leave_fewer_schedules_and_few_repetitions_tell_how_many_are_needed() {
    let folder = tempfile::tempdir().unwrap();
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
    let folder = tempfile::tempdir().unwrap();
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
