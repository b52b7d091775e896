//! Dev-dependencies change no feature of the crates that they share with the program: after `cargo run --release`, neither
//! `cargo test --release` nor `cargo bench` compiles the renderer again.

use std::collections::BTreeMap;
use std::process::Command;

/// The packages that cargo compiles along these kinds of dependencies, each with its features.
fn packages(edges: &str) -> BTreeMap<String, String> {
    let tree = ["tree", "--workspace", "--locked", "--offline", "--prefix", "none", "--format", "{p}|{f}", "--edges"];
    let output = Command::new(env!("CARGO")).args(tree).arg(edges).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    // A package that was printed before ends with a mark instead of its dependencies.
    let lines = text.lines().filter_map(|line| line.trim_end_matches(" (*)").split_once('|'));
    lines.map(|(package, features)| (package.to_string(), features.to_string())).collect()
}

#[test]
fn dev_dependencies_change_no_feature_of_a_shared_crate() {
    let [program, with_tests] = ["normal,build", "normal,build,dev"].map(packages);
    assert!(program.len() > 100 && with_tests.len() > program.len() + 20);
    let changed: Vec<_> = program.iter().filter(|(package, features)| with_tests[*package] != **features).collect();
    assert!(changed.is_empty(), "add the features to [workspace.dependencies] in Cargo.toml: {changed:?}");
}

/// Everybody who builds the program waits for each of its dependencies.
#[test]
fn the_program_has_few_dependencies() {
    let count = packages("normal,build").len();
    assert!(count <= 150, "{count} packages");
}
