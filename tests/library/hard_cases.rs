//! The table of hard cases that `pathmark selftest` prints. `PATHMARK_THOROUGH=1` uses as many random inputs as the
//! catalogue requires.

use pathmark::check::{Case, Effort, Outcome, cases, find, run};
use pathmark::measure::available_threads;
use std::collections::BTreeSet;

fn effort() -> Effort {
    if std::env::var_os("PATHMARK_THOROUGH").is_some() { Effort::Thorough } else { Effort::Quick }
}

/// The failures of a case, if any.
fn wrong(case: &Case, outcome: &Outcome) -> Vec<String> {
    let name = format!("{} {}", case.id, case.tries);
    let failures: Vec<String> = outcome.failures().map(|trial| format!("{name}: {trial:?}")).collect();
    if failures.is_empty() && !outcome.passed() { vec![format!("{name}: nothing was tried")] } else { failures }
}

#[test]
fn all_cases_pass() {
    let all: Vec<&'static Case> = cases().collect();
    let outcomes = run(&all, effort(), available_threads(), &|_| ()).unwrap();
    for (case, outcome) in all.iter().zip(&outcomes) {
        println!("{} {}: {} trials", case.id, case.tries, outcome.trials.len());
        outcome.skipped.iter().for_each(|why| println!("  not tried: {why}"));
    }
    let wrong: Vec<String> = all.iter().zip(&outcomes).flat_map(|(case, outcome)| wrong(case, outcome)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The claims on the reports name cases that there are.
#[test]
fn claims_name_cases() {
    let mut named = 0;
    for (name, text) in pathmark::experiment::claims() {
        let report: toml::Table = toml::from_str(text).unwrap();
        let of_claim = |claim: &toml::Value| claim.get("ids").and_then(toml::Value::as_array).cloned();
        for id in report["claim"].as_array().unwrap().iter().filter_map(of_claim).flatten() {
            let id = id.as_str().unwrap();
            assert!(find(id).is_some(), "{name}: {id}");
            named += 1;
        }
    }
    assert!(named > 0);
}

/// A panic is a failed trial. A case without trials fails unless it states why.
#[test]
fn cases_can_fail() {
    let case = |run| Case { id: "X00", tries: "to fail", run };
    let failed = case(|_| panic!("on purpose")).run(Effort::Quick);
    assert!(!failed.passed() && failed.failures().any(|trial| trial.found.contains("on purpose")));
    let off = case(|trials| _ = trials.close("a number", 1.0, f64::NAN, 1.0));
    assert_eq!(wrong(&off, &off.run(Effort::Quick)).len(), 1);
    let empty = case(|_| ());
    assert_eq!(wrong(&empty, &empty.run(Effort::Quick)).len(), 1);
    assert!(case(|trials| trials.skip("not here")).run(Effort::Quick).passed());
}

#[test]
fn names_are_unique() {
    let names: Vec<&str> = cases().map(|case| case.id).collect();
    assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
}
