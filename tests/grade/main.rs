//! `pathmark grade`. This test program is the program of every student, too: with names of pools in [`POOLS`] it is
//! Pathmark with these pools. Its tests run one after the other.

mod pools;
#[path = "../support/program.rs"]
mod program;
#[path = "../support/watchdog.rs"]
mod watchdog;

use pathmark::Lab;
use program::{Finished, finish, in_memory, pathmark};
use serde_json::Value;
use std::env;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;
use watchdog::Watchdog;

/// The variable with the names of the pools that this program adds.
const POOLS: &str = "PATHMARK_TEST_POOLS";

const TESTS: [(&str, fn()); 5] = [
    ("sound_pools_pass_and_share_a_letter", sound_pools_pass_and_share_a_letter),
    ("every_fault_is_caught_and_named", every_fault_is_caught_and_named),
    ("a_hanging_pool_ends_at_the_limit", a_hanging_pool_ends_at_the_limit),
    ("the_contract_is_a_verb", the_contract_is_a_verb),
    ("bad_input_is_refused_before_any_work", bad_input_is_refused_before_any_work),
];

fn main() -> ExitCode {
    if let Ok(names) = env::var(POOLS) {
        let lab = Lab::new().name("student");
        return pathmark::main(names.split_whitespace().fold(lab, |lab, name| lab.strategy(pools::named(name))));
    }
    let filters: Vec<String> = env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let is_listed = env::args().any(|argument| argument == "--list");
    for (name, test) in TESTS {
        if filters.is_empty() || filters.iter().any(|filter| name.contains(filter.as_str())) {
            println!("{name}{}", if is_listed { ": test" } else { "" });
            if !is_listed {
                test();
            }
        }
    }
    ExitCode::SUCCESS
}

/// Writes a student's program: a script that runs this program with pools.
fn student(folder: &Path, name: &str, pools: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let own = env::current_exe().unwrap();
    fs::write(&path, format!("#!/bin/sh\n{POOLS}='{pools}' exec '{}' \"$@\"\n", own.display())).unwrap();
    fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
}

fn grade(folder: &Path, arguments: &[&str], code: i32) -> Finished {
    let size = format!("size=48x{}", pools::ROWS);
    let small = ["grade", "--repetitions", "3", "--set", &size, "--set", "spp=4", "--set", "threads=2"];
    finish(pathmark(folder, &[&small, arguments].concat())).with_code(code)
}

/// The grade of a student's strategy, or of a built-in one.
fn own<'a>(grades: &'a Value, program: Option<&str>, strategy: &str) -> &'a Value {
    let mut all = grades["grades"].as_array().unwrap().iter();
    let found = all.find(|grade| grade["program"].as_str() == program && grade["strategy"] == strategy);
    found.unwrap_or_else(|| panic!("{program:?} {strategy}: {grades}"))
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

/// The commands of the rubric, with small renders.
fn sound_pools_pass_and_share_a_letter() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let text = include_str!("../../docs/course/rubric.md");
    let (_, block) = text.split_once("```sh\n").unwrap();
    let commands: Vec<&str> = block.split("```").next().unwrap().lines().collect();
    let [graded, reported] = commands[..] else { panic!("{commands:?}") };
    let programs: Vec<&str> = graded.split_whitespace().filter(|word| word.contains('/')).collect();
    for program in &programs {
        student(folder.path(), program, "sound");
    }
    let arguments: Vec<&str> = graded.split_whitespace().skip(2).collect();
    let finished = grade(folder.path(), &arguments, 0);
    let grades = json(&folder.path().join("grades.json"));
    assert_eq!(programs.len(), 2);
    for program in programs.iter().map(|program| program.replace('/', "-")) {
        let grade = own(&grades, Some(&program), "sound");
        assert_eq!(grade["verdict"], "passed", "{grade}");
        assert!(grade["speedup"].as_f64().unwrap() > 0.0 && grade["interval"]["low"].is_f64(), "{grade}");
        assert!(grade["groups"].as_array().is_some_and(|groups| !groups.is_empty()), "{grade}");
        assert!(finished.out.contains(&program), "{}", finished.out);
    }
    for reference in ["serial", "static-blocks", "shared-counter", "work-stealing", "rayon"] {
        assert_eq!(own(&grades, None, reference)["verdict"], "built in");
    }
    assert_eq!(own(&grades, None, "serial")["speedup"], 1.0);
    // Both programs are folders of a class.
    let reported: Vec<&str> = reported.split_whitespace().skip(1).collect();
    let page = finish(pathmark(folder.path(), &reported)).with_code(0);
    let page = fs::read_to_string(folder.path().join(page.out.trim())).unwrap();
    for program in &programs {
        assert!(page.contains(&format!("{}: Grade", program.replace('/', "-"))), "{program}");
    }
    // Rows are never overwritten.
    let refused = grade(folder.path(), &arguments, 2);
    assert!(refused.err.contains("records.csv"), "{}", refused.err);
}

fn every_fault_is_caught_and_named() {
    let watchdog = Watchdog::new(Duration::from_mins(3));
    let folder = tempfile::tempdir().unwrap();
    watchdog.now("the faulty pools of one program");
    student(folder.path(), "class", "lost-job early-return twice cheat sleeper sound");
    let finished = grade(folder.path(), &["class", "--json", "grades.json", "--timeout", "10min"], 1);
    let grades = json(&folder.path().join("grades.json"));
    let failed = |strategy: &str| {
        let grade = own(&grades, Some("class"), strategy);
        assert!(grade["verdict"] == "failed" && grade["speedup"].is_null(), "{grade}");
        assert!(finished.out.contains(&format!("class {strategy}: ")), "{}", finished.out);
        grade
    };
    for (strategy, promise) in [("lost-job", "EachJobOnce"), ("early-return", "End"), ("twice", "EachJobOnce")] {
        let broken = failed(strategy)["contract"].as_array().unwrap();
        assert!(broken.iter().any(|broken| broken["promise"] == promise), "{strategy}: {broken:?}");
    }
    for (strategy, told) in [("cheat", "broke its contract"), ("sleeper", "sleeps")] {
        let grade = failed(strategy);
        assert!(grade["contract"].as_array().unwrap().is_empty(), "{grade}");
        assert!(grade["faults"].to_string().contains(told), "{grade}");
    }
    assert_eq!(own(&grades, Some("class"), "sound")["verdict"], "passed");
    assert!(finished.err.contains("5 of 6 strategies have a fault"), "{}", finished.err);
}

fn a_hanging_pool_ends_at_the_limit() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    student(folder.path(), "stuck", "stuck-queue");
    let out = in_memory();
    let out = ["--out", &out.path().join("graded").display().to_string()];
    let limited = ["stuck", "--json", "grades.json", "--timeout", "12s"];
    let finished = grade(folder.path(), &[limited.as_slice(), &out].concat(), 1);
    let grades = json(&folder.path().join("grades.json"));
    let broken = &own(&grades, Some("stuck"), "stuck-queue")["contract"];
    assert_eq!(broken[0]["promise"], "End", "{grades}");
    assert!(finished.out.contains("a run ends when all its jobs have"), "{}", finished.out);
}

fn the_contract_is_a_verb() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    let kept = finish(pathmark(folder.path(), &["contract", "serial"])).with_code(0);
    assert_eq!(kept.out, "serial keeps its contract\n");
    student(folder.path(), "anna", "lost-job");
    let mut command = Command::new(folder.path().join("anna"));
    command.args(["contract", "lost-job"]).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let broken = finish(command).with_code(1);
    assert!(broken.out.starts_with("each job runs exactly once ("), "{}", broken.out);
    assert!(broken.err.contains("lost-job breaks its contract"), "{}", broken.err);
    let unknown = finish(pathmark(folder.path(), &["contract", "lost-job"])).with_code(2);
    assert!(unknown.err.contains("strategy = lost-job"), "{}", unknown.err);
}

fn bad_input_is_refused_before_any_work() {
    let _watchdog = Watchdog::new(Duration::from_mins(1));
    let folder = tempfile::tempdir().unwrap();
    student(folder.path(), "anna", "sound");
    student(folder.path(), "empty", "");
    fs::write(folder.path().join("text"), "no program").unwrap();
    for (arguments, told) in [
        (&["anna", "empty"][..], "adds no strategy"),
        (&["text"], "is not an executable program"),
        (&["/bin/true"], "cannot run the cells"),
        (&["anna", "anna"], "each program once"),
        (&["anna", "--set", "strategy=rayon"], "is set by the programs"),
        (&["anna", "--set", "decomposition=rows,tiles:8x8"], "one value for each axis"),
        (&["anna", "--set", "scene=nowhere"], "nowhere"),
        (&["anna", "--json", "nowhere/grades.json"], "nowhere/grades.json"),
        (&["anna", "--timeout", "0s"], "above 0s"),
    ] {
        let refused = grade(folder.path(), arguments, 2);
        assert!(refused.err.contains(told), "{told}: {}", refused.err);
        assert!(!folder.path().join("graded").exists(), "{arguments:?}");
    }
}
