//! Killers, which notice a fault: cases of `pathmark selftest`, or tests by their path, in any test program.

use super::fault::{packages, source_files};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

pub(crate) enum Killer {
    /// Ids of cases.
    Cases(Vec<String>),
    /// The options of `cargo test` that name the program, and the names of tests.
    Tests(Vec<String>, Vec<String>),
}

/// All cases and tests.
pub(crate) struct Killers {
    /// The path of each test: its program or `lib`, its modules by their files, and its function.
    tests: Vec<Vec<String>>,
    /// The source of the hard cases.
    cases: String,
}

impl Killers {
    pub(crate) fn read(root: &Path) -> Self {
        let cases = source_files(&root.join("crates/pathmark-check/src"))
            .iter()
            .map(|file| fs::read_to_string(file).unwrap())
            .collect();
        let mut tests = Vec::new();
        for package in packages(root) {
            for (folder, program) in [("src", Some("lib")), ("tests", None)] {
                let folder = package.join(folder);
                for file in source_files(&folder) {
                    let inner = file.strip_prefix(&folder).unwrap().with_extension("");
                    let parts = inner.iter().filter_map(|part| part.to_str());
                    let modules = parts.filter(|part| !["mod", "main"].contains(part));
                    let path: Vec<String> = program.into_iter().chain(modules).map(str::to_string).collect();
                    let text = fs::read_to_string(&file).unwrap();
                    tests.extend(functions(&text).map(|name| [path.clone(), vec![name.to_string()]].concat()));
                }
            }
        }
        Self { tests, cases }
    }

    /// Returns the cases or tests that an entry's `killed_by` names.
    pub(crate) fn find(&self, words: &str) -> Result<Killer, String> {
        match words.split_once(' ') {
            Some(("check", ids)) => self.cases(ids),
            Some(("test", path)) => self.tests(path),
            _ => Err(format!("killed_by = {words:?}: expected `check` and ids of cases, or `test` and a path")),
        }
    }

    fn cases(&self, ids: &str) -> Result<Killer, String> {
        let ids: Vec<String> = ids.split_whitespace().map(str::to_string).collect();
        match ids.iter().find(|id| !self.cases.contains(&format!("\"{id}\""))) {
            Some(id) => Err(format!("no case is called {id}")),
            None => Ok(Killer::Cases(ids)),
        }
    }

    fn tests(&self, path: &str) -> Result<Killer, String> {
        let wanted: Vec<&str> = path.split("::").collect();
        let meant = self.tests.iter().filter(|test| test.windows(wanted.len()).any(|window| window == wanted));
        let (programs, names): (BTreeSet<&String>, Vec<String>) =
            meant.map(|test| (&test[0], test[test.len() - 1].clone())).unzip();
        match Vec::from_iter(programs)[..] {
            [] => Err(format!("no test has {path} in its path")),
            [program] if program == "lib" => Ok(Killer::Tests(vec!["--lib".into()], names)),
            [program] => Ok(Killer::Tests(vec!["--test".into(), program.clone()], names)),
            ref several => Err(format!("{path} is in several programs: {several:?}")),
        }
    }
}

/// The names of the functions marked `#[test]`.
fn functions(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split("#[test]").skip(1);
    after.filter_map(|text| text.split_once("fn ")?.1.split_once('(')).map(|(name, _)| name)
}
