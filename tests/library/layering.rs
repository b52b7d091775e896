//! Each module imports only modules above it (CONTRIBUTING, Layers), so that a part can be understood, tested and replaced without those that
//! use it. The compiler does not mind cycles among modules; this test does.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What a module of `src/` may import: everything of a lower layer and what is in `beside`, or, if there is an `only`, just that.
struct Rule {
    module: &'static str,
    layer: u8,
    beside: &'static [&'static str],
    only: Option<&'static [&'static str]>,
}

const fn rule(module: &'static str, layer: u8) -> Rule {
    Rule { module, layer, beside: &[], only: None }
}

const fn beside(module: &'static str, layer: u8, beside: &'static [&'static str]) -> Rule {
    Rule { module, layer, beside, only: None }
}

const fn only(module: &'static str, layer: u8, only: &'static [&'static str]) -> Rule {
    Rule { module, layer, beside: &[], only: Some(only) }
}

/// A new module gets its line here, and the line is where to argue about its place.
const RULES: &[Rule] = &[
    rule("error", 0),
    rule("math", 0),
    rule("digest", 0),
    rule("effect", 0),
    beside("input", 0, &["error", "math"]), // errors with a place; numbers that become vectors and colours
    rule("disk", 0),
    beside("simd", 0, &["math"]), // the same formulas, several numbers at once
    rule("file_id", 0),
    beside("lock", 0, &["error", "digest", "file_id"]),
    beside("temporary", 0, &["disk", "lock"]),
    beside("atomic_file", 0, &["error", "disk", "file_id", "temporary"]),
    beside("files", 0, &["error", "file_id", "atomic_file"]),
    rule("image_io", 1),
    beside("metric", 1, &["image_io"]), // metrics compare images
    only("analysis", 1, &[]),           // statistics on plain numbers, whatever was measured
    rule("sampling", 1),
    rule("material", 2),
    rule("scene", 3),
    // How a film is cut and added up is nobody's business who estimates radiance, and the other way round.
    rule("film", 4),
    rule("estimator", 4),
    rule("kernel", 5),
    beside("lab", 5, &["kernel", "strategy"]), // what there is to choose from
    // A strategy schedules integers: in a crate of its own it cannot see a pixel. It shares the kernel's layer, so that only `measure`
    // and what uses it can bring the two together.
    only("strategy", 5, &[]),
    rule("measure", 6),
    only("simulate", 7, &["analysis", "lab", "measure", "strategy"]), // numbers in, numbers out: no pixel, no thread, no clock
    rule("experiment", 8),
    beside("check", 8, &["experiment"]), // tries all that the renderer is made of
    only("plot", 9, &["error", "atomic_file", "metric", "image_io"]), // draws numbers, whatever they were measured on
    beside("report", 9, &["plot"]),
    rule("cli", 10),
];

impl Rule {
    fn of(module: &str) -> Option<&'static Self> {
        RULES.iter().find(|rule| rule.module == module)
    }

    fn allows(&self, target: &str) -> bool {
        let lower = Self::of(target).is_some_and(|rule| rule.layer < self.layer);
        target == self.module || self.only.map_or(lower || self.beside.contains(&target), |only| only.contains(&target))
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Where code of ours lies: its lints and its lines are everyone's.
const FOLDERS: [&str; 5] = ["src", "tests", "benches", "crates", "examples"];

/// Where a module's files are: a crate of its own that the package re-exports, a folder or a file.
fn home(module: &str) -> Option<PathBuf> {
    let places = [format!("crates/pathmark-{module}"), format!("src/{module}"), format!("src/{module}.rs")];
    places.into_iter().map(|place| root().join(place)).find(|place| place.exists())
}

/// The Rust files below a folder of the package; none if there is no such folder.
fn rust_files(folder: &str) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![root().join(folder)]);
    while let Some(entries) = folders.pop().map(fs::read_dir) {
        for path in entries.into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The code without what follows `//`, so that documentation may mention any module.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// The names that follow a path's prefix: one, or the heads of a group in braces.
fn heads(rest: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let rest = rest.trim_start();
    let Some(group) = rest.strip_prefix('{') else { return vec![word(rest)] };
    let (mut heads, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                heads.push(word(group[start..at].trim_start()));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    heads
}

/// The top-level modules that a file at this depth names: `crate::x`, and as many `super::` as lead to the root.
fn imports(text: &str, depth: usize) -> BTreeSet<String> {
    let code = code(text);
    let mut found = BTreeSet::new();
    for prefix in ["crate::".to_string(), "super::".repeat(depth)] {
        for (at, _) in code.match_indices(&prefix) {
            found.extend(heads(&code[at + prefix.len()..]));
        }
    }
    found.retain(|name| !name.is_empty() && home(name).is_some());
    found
}

#[test]
fn imports_are_found_wherever_they_stand() {
    // `strategy` is a crate, which looks like a module to those that import it.
    assert_eq!(Vec::from_iter(imports("use crate::strategy::{Config, find};", 1)), ["strategy"]);
    let text = "use crate::{error::{Error, Result}, film::Film};\nuse crate::math::Vec3; // crate::cli\nfn f() { crate::scene::load() }";
    assert_eq!(Vec::from_iter(imports(text, 1)), ["error", "film", "math", "scene"]);
    assert_eq!(Vec::from_iter(imports("use super::super::cli; use super::plan;", 2)), ["cli"]);
    assert_eq!(Vec::from_iter(imports("use super::cli;", 1)), ["cli"]);
}

#[test]
fn modules_import_only_those_above() {
    let source = root().join("src");
    let (mut wrong, mut seen) = (Vec::new(), BTreeSet::new());
    for file in rust_files("src") {
        let inner = file.strip_prefix(&source).unwrap();
        let shown = inner.display();
        let module = inner.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        // The crate's roots name every module, in its declaration or by calling `cli`.
        if ["lib", "main"].contains(&module) {
            continue;
        }
        let Some(rule) = Rule::of(module) else {
            wrong.push(format!("{shown}: module {module} has no line in the table of this test"));
            continue;
        };
        seen.insert(rule.module);
        let parts = inner.components().count();
        let depth = if inner.ends_with("mod.rs") { parts - 1 } else { parts };
        let targets = imports(&fs::read_to_string(&file).unwrap(), depth);
        wrong.extend(targets.iter().filter(|t| !rule.allows(t)).map(|t| format!("{shown}: {module} imports {t}")));
    }
    for rule in RULES.iter().filter(|rule| !seen.contains(rule.module)) {
        let is_crate = home(rule.module).is_some_and(|home| home.starts_with(root().join("crates")));
        if !is_crate {
            wrong.push(format!("the table has {}, which src/ has not", rule.module));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// A lint is satisfied or argued about in Cargo.toml, where it is seen.
#[test]
fn no_file_silences_a_lint() {
    // In two parts, or this file would accuse itself.
    let silenced = [concat!("#[al", "low("), concat!("#![al", "low("), concat!(", al", "low(")];
    let mut wrong = Vec::new();
    for file in FOLDERS.into_iter().flat_map(rust_files) {
        let code = code(&fs::read_to_string(&file).unwrap());
        let attributes = code.lines().filter(|line| line.trim_start().starts_with('#'));
        if attributes.into_iter().any(|line| silenced.iter().any(|text| line.contains(text))) {
            wrong.push(file);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn files_hold_one_idea() {
    let lines = |file: &PathBuf| fs::read_to_string(file).unwrap().lines().count();
    let files = FOLDERS.into_iter().flat_map(rust_files);
    let long: Vec<_> = files.filter(|file| lines(file) > 400).collect();
    assert!(long.is_empty(), "more than 400 lines: {long:?}");
}
