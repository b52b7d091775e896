//! Verdicts for pages and other programs: `claims`, `diff`, `rank` and `replicate` print JSON and tables in Markdown.

use crate::diff::{base, measured, steady};
use crate::program::{finish, in_memory, pathmark};
use serde_json::Value;

/// Asserts that a text has tables, and that all of their lines have as many cells as their heads.
fn assert_has_tables(text: &str) {
    let lines: Vec<&str> = text.lines().collect();
    let is_rule = |line: &str| line.starts_with("|-") && line.chars().all(|own| "|-:".contains(own));
    let rules: Vec<usize> = (1..lines.len()).filter(|at| is_rule(lines[*at])).collect();
    assert!(!rules.is_empty(), "{text}");
    for rule in rules {
        assert!(rule == 1 || lines[rule - 2].is_empty(), "no blank line before a table: {text}");
        let bars = |line: &str| line.replace("\\|", "").matches('|').count();
        let rows = lines[rule - 1..].iter().take_while(|line| line.starts_with('|'));
        assert!(rows.clone().all(|line| bars(line) == bars(lines[rule]) && line.ends_with('|')), "{text}");
        assert!(rows.count() > 1, "{text}");
    }
}

#[test]
fn verdicts_are_printed_as_json_and_as_tables() {
    let folder = in_memory();
    base(folder.path());
    measured(folder.path(), "new", steady);
    for command in [
        "rank old",
        "diff old new",
        "diff old new --counts",
        "claims base",
        "claims base --compare base",
        "replicate base --out here --resume",
    ] {
        let printed = |form: &str| {
            let words: Vec<&str> = command.split(' ').chain([form]).collect();
            let finished = finish(pathmark(folder.path(), &words));
            // Real times of some microseconds may have any verdict.
            let codes = if command.starts_with("replicate") { vec![Some(0), Some(1)] } else { vec![Some(0)] };
            assert!(codes.contains(&finished.code), "{command}: {}", finished.err);
            finished.out
        };
        let json: Value = serde_json::from_str(&printed("--json")).unwrap_or_else(|e| panic!("{command}: {e}"));
        assert!(json.is_array() || json.is_object(), "{command}: {json}");
        assert_has_tables(&printed("--markdown"));
    }
}
