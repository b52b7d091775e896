//! `why`: why is a schedule not as many times as fast as it has workers?

use crate::diff::{json, run};
use crate::experiment::{TINY, write_tiny};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

#[test]
fn the_parts_of_a_real_sweep_add_up_within_their_intervals() {
    let folder = tempfile::tempdir().unwrap();
    let text = TINY.replace("\"schedules\"", "\"schedules\", \"losses\"");
    write_tiny(folder.path(), &text);
    run(folder.path(), &["run", "tiny.toml"], 0);
    let found = json(&run(folder.path(), &["why", "out/tiny", "--json"], 0));
    let schedules = found["schedules"].as_array().unwrap();
    let mut names: Vec<&str> = schedules.iter().map(|own| own["strategy"].as_str().unwrap()).collect();
    names.sort_unstable();
    assert_eq!(names, ["static-blocks", "work-stealing"]);
    for schedule in schedules {
        let parts = schedule["parts"].as_array().unwrap();
        assert_eq!((parts[0]["part"].as_str(), schedule["knows_starts"].as_bool()), (Some("work"), Some(true)));
        // Each repetition's parts add up to 1, so the least and the greatest shares enclose it.
        let sum = |end: &str| parts.iter().map(|part| part["interval"][end].as_f64().unwrap()).sum::<f64>();
        assert!(sum("low") <= 1.0 + 1e-9 && sum("high") >= 1.0 - 1e-9, "{schedule}");
        assert!(parts.iter().all(|part| part["count"] == 3), "{schedule}");
    }
    let printed = run(folder.path(), &["why", "out/tiny"], 0);
    for schedule in schedules {
        assert!(printed.out.contains(schedule["sentence"].as_str().unwrap()), "{}", printed.out);
    }
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("Why not N times?") && page.contains("id=\"tiny-losses\""));
    for file in ["losses.svg", "losses.png", "losses.csv"] {
        assert!(folder.path().join("out/tiny/figures").join(file).is_file(), "{file}");
    }
    // The commands that it prints run one after the other, and so do those for the rows that they make.
    // Two schedules may have the same remedy.
    let remedies = |schedules: &[Value]| -> BTreeSet<String> {
        let all = schedules.iter().filter_map(|own| own["remedy"]["command"].as_str());
        all.filter_map(|command| Some(command.split_once(' ')?.1.to_string())).collect()
    };
    for arguments in remedies(schedules) {
        let words: Vec<&str> = arguments.split(' ').collect();
        run(folder.path(), &words, 0);
        let made = format!("{}/tiny", words.last().unwrap());
        assert!(folder.path().join(&made).join("records.csv").is_file(), "{arguments}");
        let again = json(&run(folder.path(), &["why", &made, "--json"], 0));
        for next in remedies(again["schedules"].as_array().unwrap()) {
            assert_eq!(next.matches("--set strategy=").count(), 1, "{next}");
            assert!(next == arguments || !next.ends_with(words.last().unwrap()), "{next}");
        }
    }
}

#[test]
fn folders_without_losses_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &TINY.replace("figures = [\"speedup\", \"schedules\"]", "figures = []"));
    let only = ["--filter", "strategy=work-stealing", "--repetitions", "1"];
    run(folder.path(), &[&["run", "tiny.toml"], &only[..]].concat(), 0);
    fs::create_dir(folder.path().join("empty")).unwrap();
    for (arguments, said) in [
        (&["why", "nowhere"][..], "nowhere"),
        (&["why", "tiny.toml"], "is not a folder"),
        (&["why", "empty"], "no such file"),
        (&["why", "out/tiny"], "no schedule of several workers"),
    ] {
        let finished = run(folder.path(), arguments, 2);
        assert!(finished.err.contains(said), "{said} is not in {}", finished.err);
    }
}
