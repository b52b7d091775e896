//! The contract names the fault of each exercise. The documentation tests of the answers show that it finds none in the
//! mended pools.

use std::thread;

use pathmark_exercises::{EXERCISES, verify};

#[test]
fn the_contract_names_the_fault_of_each_exercise() {
    let judged = thread::scope(|scope| {
        let started = EXERCISES.map(|(entry, promise)| (entry, promise, scope.spawn(move || verify(&entry))));
        started.map(|(entry, promise, judge)| (entry.name, promise, judge.join().unwrap()))
    });
    for (name, promise, verdict) in judged {
        let violations = verdict.err().unwrap_or_default();
        assert!(violations.iter().any(|violation| violation.promise == promise), "{name}: {violations:#?}");
    }
}

/// Each exercise has a line in the list for students, and an answer.
#[test]
fn every_exercise_is_told() {
    let (list, answers) = (include_str!("../README.md"), include_str!("../../docs/course/exercises.md"));
    for (entry, _) in EXERCISES {
        let file = entry.name.replace('-', "_");
        assert!(list.contains(&format!("[`{file}`]({file}.rs)")), "{file}");
        assert!(answers.contains(&format!("verify_mended!({file}, run);")), "{file}");
    }
}
