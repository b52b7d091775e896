//! Named faults, each with the case or test that notices it: `mutants.toml`. They are applied by matching text, so they
//! survive moved code.

mod fault;
mod killer;
mod trial;

use fault::{Fault, Sources};
use killer::Killers;
use std::collections::BTreeMap;
use std::path::Path;
use trial::{Outcome, Scratch};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn faults() -> BTreeMap<String, Fault> {
    toml::from_str(include_str!("mutants.toml")).unwrap_or_else(|problem| panic!("mutants.toml: {problem}"))
}

#[test]
fn every_fault_applies() {
    let sources = Sources::read(root());
    let refused = |(name, fault): (String, Fault)| Some(format!("{name}: {}", fault.apply(&sources).err()?));
    let wrong: Vec<_> = faults().into_iter().filter_map(refused).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn every_killer_exists() {
    let killers = Killers::read(root());
    let unknown = |(name, fault): (String, Fault)| Some(format!("{name}: {}", killers.find(&fault.killed_by).err()?));
    let wrong: Vec<_> = faults().into_iter().filter_map(unknown).collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// The text may have moved to another file or have other line breaks. A text that occurs twice or not at all is an
/// error.
#[test]
fn a_fault_is_applied_wherever_its_text_stands_once() {
    let sources =
        |texts: &[(&str, &str)]| texts.iter().map(|&(file, text)| (file.into(), text.into())).collect::<Sources>();
    let fault = |edits: &str| toml::from_str::<Fault>(&format!("killed_by = ''\nedits = [{edits}]")).unwrap();
    let applied = |edits: &str, texts: &[(&str, &str)]| fault(edits).apply(&sources(texts));
    let sum = "{ old = 'a + b', new = 'a - b' }";
    assert_eq!(applied(sum, &[("x", "f(a +\n    b)"), ("y", "a")]).unwrap(), [("x".into(), "f(a - b)".into())].into());
    assert_eq!(applied(sum, &[("x", "a + b"), ("y", "a+b")]).unwrap_err(), "`a + b` stands 2 times in all sources");
    assert_eq!(applied(sum, &[("x", "a * b")]).unwrap_err(), "`a + b` stands 0 times in all sources");
    let one = "{ file = 'y', old = 'a + b', new = 'c' }";
    assert_eq!(applied(one, &[("x", "a + b"), ("y", "a + b")]).unwrap(), [("y".into(), "c".into())].into());
    assert_eq!(applied(one, &[("x", "a + b")]).unwrap_err(), "`a + b` stands 0 times in y");
    let twice = format!("{sum}, {{ old = 'f(', new = 'g(' }}");
    assert_eq!(applied(&twice, &[("x", "f(a + b)")]).unwrap(), [("x".into(), "g(a - b)".into())].into());
    assert_eq!(applied("{ old = 'a', new = 'a' }", &[("x", "a")]).unwrap_err(), "`a` is replaced by itself");
}

/// `tests/mutants/run.sh` calls this. Words in `PATHMARK_MUTANTS` choose the faults whose names contain one of them.
#[test]
#[ignore = "takes hours: tests/mutants/run.sh"]
fn every_fault_is_noticed() {
    let words = std::env::var("PATHMARK_MUTANTS").unwrap_or_default();
    let words: Vec<&str> = words.split_whitespace().collect();
    let is_chosen = |name: &String| words.is_empty() || words.iter().any(|word| name.contains(word));
    let scratch = Scratch::new(root());
    let (mut killed, mut others) = (0, 0);
    for (name, fault) in faults().into_iter().filter(|(name, _)| is_chosen(name)) {
        let outcome = scratch.try_fault(&fault);
        println!("{name}: {outcome}");
        *if matches!(outcome, Outcome::Killed(_)) { &mut killed } else { &mut others } += 1;
    }
    println!("{killed} killed, {others} survived or not tried");
    assert_eq!(others, 0, "faults that nobody notices");
}
