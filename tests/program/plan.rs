//! `reproduce --plan` prints the expected effort and leaves the disk alone.

use crate::program::{finish, pathmark};

/// The columns of each line of the table.
fn lines(out: &str) -> Vec<Vec<&str>> {
    let lines = out.lines().map(|line| line.split_whitespace().collect::<Vec<&str>>());
    lines.take_while(|line| line.first() != Some(&"Seconds")).collect()
}

#[test]
fn a_plan_counts_the_experiments_of_a_profile_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let finished = finish(pathmark(folder.path(), &["reproduce", "--reports", "--plan", "--out", "new"])).with_code(0);
    let lines = lines(&finished.out);
    let (head, rows) = lines.split_first().unwrap();
    let (all, each) = rows.split_last().unwrap();
    assert_eq!((head[0], all[0]), ("experiment", "all"));
    for name in ["spp-quality", "report-a-as-it-is", "report-b-bands", "report-c", "report-d"] {
        assert!(each.iter().any(|line| line[0] == name), "{name} is not in {}", finished.out);
    }
    assert!(each.iter().all(|line| line[0] != "gallery"), "it has no profile of that name");
    for column in [1, 2] {
        let count = |line: &Vec<&str>| line[column].parse::<u64>().unwrap();
        assert_eq!(each.iter().map(count).sum::<u64>(), count(all), "{}", head[column]);
    }
    assert!(all[3].parse::<f64>().unwrap() > 60.0, "seconds: {all:?}");
    assert!(finished.out.contains("Seconds are an estimate"), "{}", finished.out);
    assert!(finished.out.contains("do not have this profile"), "{}", finished.out);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "a plan writes nothing");
}
