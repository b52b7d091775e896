//! The commands that the page offers run, and files say which program made them.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, pathmark};
use assert_cmd::cargo::cargo_bin;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// The commands of each section of a page, as the page's script reads them.
fn offered(page: &Path) -> Vec<Value> {
    let page = fs::read_to_string(page).unwrap();
    let parts = page.split("data-again=\"").skip(1).map(|part| part.split('"').next().unwrap());
    parts.map(|part| serde_json::from_str(&unescaped(part)).unwrap()).collect()
}

/// Every filter of an experiment from a file, with a scene from a file and other values, all with names that a shell
/// would take apart.
#[test]
fn the_commands_of_the_page_run() {
    let folder = tempfile::tempdir().unwrap();
    let (experiment, scene) = ("my files/it's \"$5\".toml", "my files/a $room.toml");
    fs::create_dir(folder.path().join("my files")).unwrap();
    fs::write(folder.path().join(scene), "about = \"A room\"\nbase = \"cornell\"\n").unwrap();
    let text = TINY.replace("\"static-blocks\", ", "").replace("repetitions = 10", "repetitions = 1");
    fs::write(folder.path().join(experiment), &text).unwrap();
    let values = format!("scene={scene}");
    finish(pathmark(folder.path(), &["run", experiment, "--full", "--set", &values, "--out", "out"])).with_code(0);
    let offers = offered(&folder.path().join("out/report.html"));
    assert_eq!(offers.len(), 1);
    let offer = &offers[0];
    let word = |value: &Value| value.as_str().unwrap().to_string();
    let (head, end) = (word(&offer["run"]), word(&offer["out"]));
    assert!(head.contains(" --full --set "), "{head}");
    let filters: BTreeSet<String> = offer["filters"].as_object().unwrap().values().map(word).collect();
    assert!(filters.contains("--filter 'scene=my files/a $room.toml'"), "{filters:?}");
    assert!(filters.contains("--filter strategy=work-stealing"), "{filters:?}");
    for filter in filters.iter().map(String::as_str).chain([""]) {
        in_shell(&format!("{head} {filter} {end}"), folder.path());
    }
    // Rows of a file that was edited since cannot be measured again, so nothing is offered.
    fs::write(folder.path().join(experiment), text.replace("spp = [4]", "spp = [8]")).unwrap();
    finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
    assert!(offered(&folder.path().join("out/report.html")).is_empty());
}

/// Text of a page with its escapes undone.
fn unescaped(text: &str) -> String {
    text.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

/// The texts between two marks of a page.
fn between<'a>(page: &'a str, start: &str, end: &str) -> Vec<&'a str> {
    page.split(start).skip(1).filter_map(|part| part.split(end).next()).collect()
}

/// Every link that leads out of the page leads to a file beside it, every figure links to its rows and commands, and the
/// commands run as they are printed: one draws the same figures again.
#[test]
fn links_lead_to_files_and_figures_are_drawn_again() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &TINY.replace("repetitions = 3", "repetitions = 1"));
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    let out = folder.path().join("out");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let links: BTreeSet<&str> = between(&page, "href=\"", "\"").into_iter().collect();
    let files: Vec<&str> =
        links.iter().copied().filter(|link| !link.starts_with('#') && !link.contains("://")).collect();
    assert!(files.contains(&"tiny/records.csv") && files.contains(&"tiny/machine.toml"), "{files:?}");
    for file in files {
        assert!(out.join(file).is_file(), "{file}");
    }
    let captions = between(&page, "<figcaption>", "</figcaption>");
    assert_eq!(captions.len(), page.matches("<figure").count());
    for caption in captions {
        assert!(caption.contains("href=\"tiny/records.csv\"") && caption.contains("href=\"#tiny-again\""), "{caption}");
    }
    assert!(page.contains("id=\"tiny-again\""));
    let printed = |kind: &str| unescaped(between(&page, &format!("<code class=\"{kind}\">"), "</code>")[0]);
    let figure = out.join("tiny/figures/speedup.svg");
    let drawn = fs::read(&figure).unwrap();
    fs::remove_dir_all(out.join("tiny/figures")).unwrap();
    in_shell(&printed("redraw"), &out);
    assert_eq!(fs::read(&figure).unwrap(), drawn);
    in_shell(&printed("measure"), folder.path());
}

/// Runs a line in a shell that finds the program.
fn in_shell(line: &str, folder: &Path) {
    let mut path = cargo_bin!("pathmark").parent().unwrap().as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut shell = Command::new("sh");
    shell.args(["-c", line]).env("PATH", &path).env("TMPDIR", folder).current_dir(folder);
    let output = shell.output().unwrap();
    assert!(output.status.success(), "{line}\n{}", String::from_utf8_lossy(&output.stderr));
}

/// The page's script joins the parts of a command, which are quoted already. Needs Node; without it the test says so and
/// passes.
#[test]
fn the_script_of_the_page_joins_the_parts_of_a_command() {
    if !Command::new("node").arg("--version").output().is_ok_and(|told| told.status.success()) {
        eprintln!("skipped: there is no Node");
        return;
    }
    let script = include_str!("../../crates/pathmark-report/assets/report.js");
    let (_, own) = script.split_once("const commandOf = ").unwrap();
    let (own, _) = own.split_once("\n  };\n").unwrap();
    let again = r#"{ run: "pathmark run 'a b.toml'", filters: { "it's": "--filter 'scene=it'\\''s'", serial: "--filter strategy=serial" }, out: "--out x" }"#;
    let note = "{ closest: () => ({ dataset: { again: JSON.stringify(again) } }), dataset: { series: \"it's + toString\", of: \"serial, 2 threads\" } }";
    let code = format!("const again = {again}; const commandOf = {own}\n}}; console.log(commandOf({note}));");
    let output = Command::new("node").args(["-e", &code]).output().unwrap();
    let line = String::from_utf8(output.stdout).unwrap();
    let expected = r"pathmark run 'a b.toml' --filter 'scene=it'\''s' --filter strategy=serial --out x";
    assert_eq!(line.trim_end(), expected, "{}", String::from_utf8_lossy(&output.stderr));
}

/// Commands in messages are quoted, too.
#[test]
fn a_new_file_is_named_as_a_shell_reads_it() {
    let folder = tempfile::tempdir().unwrap();
    let told = finish(pathmark(folder.path(), &["new", "experiment", "my first"])).with_code(0).out;
    assert!(told.trim_end().ends_with("pathmark run 'my first.toml'"), "{told}");
}

/// A program that a user built has its own name in what it writes, and so has the program that it is compared with.
#[test]
fn files_name_the_program_that_made_them() {
    let folder = tempfile::tempdir().unwrap();
    write_tiny(folder.path(), &TINY.replace("repetitions = 3", "repetitions = 1"));
    let [own, other] = ["mypool", "mypool-before"].map(|name| folder.path().join(name));
    for program in [&own, &other] {
        fs::copy(cargo_bin!("pathmark"), program).unwrap();
    }
    let harness = concat!("(Pathmark ", env!("CARGO_PKG_VERSION"), ")");
    let output =
        Command::new(&own).args(["run", "tiny.toml", "--baseline"]).arg(&other).current_dir(folder.path()).output();
    assert!(output.unwrap().status.success());
    let machine =
        |path: &str| -> toml::Table { toml::from_str(&fs::read_to_string(folder.path().join(path)).unwrap()).unwrap() };
    let told = |path: &str| machine(path)["program"].as_str().unwrap().to_string();
    assert_eq!(told("out/tiny/machine.toml"), format!("mypool {harness}"));
    assert_eq!(told("out/baseline/tiny/machine.toml"), format!("mypool-before {harness}"));
    let command = machine("out/tiny/machine.toml")["command"].as_str().unwrap().to_string();
    assert!(command.starts_with("mypool run tiny.toml --baseline "), "{command}");
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains(&format!("mypool {harness}")), "{page}");
    // Pathmark itself needs no second name.
    let version = finish(pathmark(folder.path(), &["--version"])).with_code(0).out;
    assert_eq!(version.trim(), concat!("pathmark ", env!("CARGO_PKG_VERSION")));
}
