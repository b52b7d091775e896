//! The table of hard cases that `pathmark check` prints, section by section. `PATHMARK_THOROUGH=1` takes as many random inputs as the
//! catalogue asks for.

use pathmark::check::{Effort, SECTIONS};
use std::collections::BTreeSet;

fn effort() -> Effort {
    if std::env::var_os("PATHMARK_THOROUGH").is_some() { Effort::Thorough } else { Effort::Quick }
}

/// Tries the cases of the section whose title begins so, and prints what came of each.
fn section_holds(title: &str) {
    let section = SECTIONS.iter().find(|section| section.title.starts_with(title)).expect("a section of that title");
    let mut wrong = Vec::new();
    for case in section.cases.iter().copied().flatten() {
        let outcome = case.run(effort());
        println!("{} {}: {} trials", case.id, case.tries, outcome.trials.len());
        outcome.skipped.iter().for_each(|why| println!("  not tried: {why}"));
        wrong.extend(outcome.failures().map(|trial| format!("{} {}: {trial:?}", case.id, case.tries)));
        if !outcome.passed() && outcome.failures().next().is_none() {
            wrong.push(format!("{} {}: nothing was tried", case.id, case.tries));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn sphere_holds() {
    section_holds("Ray against sphere");
}

#[test]
fn triangle_holds() {
    section_holds("Triangles");
}

#[test]
fn shading_holds() {
    section_holds("Frames");
}

#[test]
fn path_holds() {
    section_holds("Paths");
}

#[test]
fn random_numbers_hold() {
    section_holds("Random numbers");
}

#[test]
fn statistics_hold() {
    section_holds("Statistics");
}

#[test]
fn analytic_scenes_hold() {
    section_holds("Scenes");
}

#[test]
fn names_are_unique() {
    let names: Vec<&str> = pathmark::check::cases().map(|case| case.id).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
}
