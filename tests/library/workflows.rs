//! The workflows and the container do what the repository says: its oldest Rust, its scripts, README's first commands.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(name: &str) -> String {
    fs::read_to_string(root().join(name)).unwrap()
}

const WORKFLOWS: [&str; 2] = [".github/workflows/ci.yml", ".github/workflows/release.yml"];
const CONTAINER: &str = "Containerfile";

/// The command lines of a workflow's steps: `run: COMMAND`, or the deeper lines after `run: |`.
fn commands(workflow: &str) -> Vec<String> {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let mut commands = Vec::new();
    let mut lines = workflow.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(command) = line.trim_start().trim_start_matches("- ").strip_prefix("run: ") else { continue };
        if command != "|" {
            commands.push(command.to_string());
            continue;
        }
        while let Some(inner) = lines.next_if(|inner| indent(inner) > indent(line)) {
            commands.push(inner.trim().to_string());
        }
    }
    commands
}

/// The commands of README.md's first block, without their comments.
fn first_commands() -> Vec<String> {
    let readme = read("README.md");
    let (_, block) = readme.split_once("```sh\n").unwrap();
    let (block, _) = block.split_once("```").unwrap();
    block.lines().map(|line| line.split('#').next().unwrap().trim().to_string()).collect()
}

#[test]
fn workflows_and_the_container_use_the_oldest_rust() {
    let oldest = env!("CARGO_PKG_RUST_VERSION");
    let mut used = BTreeSet::new();
    for workflow in WORKFLOWS {
        for command in commands(&read(workflow)).iter().filter(|command| command.contains("toolchain install ")) {
            let version = command.split_once("toolchain install ").unwrap().1.split(' ').next().unwrap().to_string();
            assert!(command.ends_with(&format!("rustup default {version}")), "{workflow}: {command}");
            used.insert(version);
        }
    }
    assert_eq!(used, BTreeSet::from([oldest.to_string(), "stable".to_string()]));
    let container = read(CONTAINER);
    assert!(container.contains(&format!("\nARG RUST={oldest}.")), "{container}");
    // The containers of artifacts are built on the same system.
    let base = container.lines().find(|line| line.starts_with("FROM ")).unwrap();
    assert!(read("crates/pathmark-report/src/artifact/recipes.rs").contains(base), "{base}");
}

#[test]
fn workflows_and_the_container_run_the_first_commands_of_the_readme() {
    let commands = commands(&read(WORKFLOWS[0]));
    let first = first_commands();
    let [clone, reproduce, install, claims, test] = &first[..] else { panic!("{first:?}") };
    assert!(clone.starts_with("git clone "), "{clone}");
    for command in [reproduce, install, claims, test] {
        assert!(commands.contains(command), "{command}: {commands:#?}");
    }
    let reproduce = reproduce.replace("cargo run --release --", "pathmark");
    let container = read(CONTAINER);
    assert!(container.contains(&format!("{reproduce} && {claims}")) && container.contains(install), "{container}");
}

#[test]
fn scripts_of_workflows_exist() {
    let mut scripts = 0;
    for command in WORKFLOWS.iter().flat_map(|workflow| commands(&read(workflow))) {
        let Some(script) = command.split(' ').skip_while(|word| *word != "bash").nth(1) else { continue };
        assert!(root().join(script).is_file(), "{command}");
        scripts += 1;
    }
    assert!(scripts >= 4, "{scripts} scripts");
}

/// The workflow's comparison notices another checksum, a missing render, and files without any checksum. It leaves out
/// what a device has no program for.
#[test]
fn the_comparison_of_processors_notices_differences() {
    let folder = tempfile::tempdir().unwrap();
    let expected = "a --precision f64|checksum 1\na --precision f32|checksum 2\nb --precision f32|exit 2\n\
                    c --precision f64|checksum 3\n";
    let cases = [
        (expected.to_string(), true),
        (expected.replace("checksum 3", "another kernel"), true),
        (expected.replace("checksum 2", "another kernel"), false),
        (expected.replace("checksum 2", "checksum 4"), false),
        (expected.replace("exit 2", "checksum 2"), false),
        (expected.replace("b --precision f32|exit 2\n", ""), false),
    ];
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path
    };
    let equal = |expected: &str, found: &str| {
        let script = root().join("tests/portability/compare.sh");
        let files = [file("expected", expected), file("found", found)];
        Command::new("bash").arg(script).args(files).output().unwrap().status.success()
    };
    for (found, is_same) in cases {
        assert_eq!(equal(expected, &found), is_same, "{found}");
    }
    let nothing = ["checksum 1", "checksum 2", "checksum 3"]
        .iter()
        .fold(expected.to_string(), |text, checksum| text.replace(checksum, "exit 2"));
    assert!(!equal(&nothing, &nothing));
}
