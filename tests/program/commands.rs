//! The commands in the documents run as printed there.

use crate::experiment::TINY;
use crate::program::{finish, in_memory, pathmark};
use std::fs;
use std::path::Path;
use std::process::Command;

/// The fenced blocks of a document in order, each with its language.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let mut parts = text.split("\n```");
    parts.next();
    // After each opening fence come the language and the block; after each closing fence, the text between blocks.
    parts.step_by(2).filter_map(|part| part.split_once('\n')).collect()
}

/// The README's commands in a small size, without those that take an hour, need a feature or run in other tests.
#[test]
fn the_commands_of_the_readme_run() {
    const ELSEWHERE: [&str; 8] = [
        "pathmark diff",
        "pathmark reproduce",
        "pathmark claims out --compare",
        "pathmark replicate",
        "pathmark selftest",
        "pathmark run openmp",
        "pathmark run granularity --baseline",
        "pathmark VERB",
    ];
    let folder = in_memory();
    let mut commands = 0;
    let text = include_str!("../../README.md");
    for line in blocks(text).into_iter().filter(|(language, _)| *language == "sh").flat_map(|(_, block)| block.lines())
    {
        let (command, _) = line.split_once('#').unwrap_or((line, ""));
        if !command.starts_with("pathmark ") || ELSEWHERE.iter().any(|own| command.starts_with(own)) {
            continue;
        }
        let mut small = command.replace("256x192", "32x24");
        let more = match command.split_whitespace().nth(1) {
            Some("run") => " --set size=32x24 --repetitions 1",
            // The check predicts this machine first, which takes fifteen seconds of renders; other tests cover it.
            Some("simulate") => " --no-check",
            Some("price") => " --size 32x24",
            Some("render") if !command.contains("--size") => " --size 128x201",
            Some("inspect") if command.contains("--pixel") => " --size 128x201",
            _ => "",
        };
        small += more;
        let words: Vec<&str> = small.split_whitespace().collect();
        finish(pathmark(folder.path(), &words[1..])).with_code(0);
        commands += 1;
    }
    assert!(commands > 10, "{commands} commands");
}

/// The shortest ledger of the manual measures its number.
#[test]
fn the_ledger_of_the_manual_gives_a_number() {
    let folder = in_memory();
    let text = include_str!("../../examples/ledgers/README.md");
    let ledger = blocks(text).into_iter().map(|(_, block)| block).find(|block| block.starts_with("# paper.toml"));
    fs::write(folder.path().join("paper.toml"), ledger.expect("a ledger")).unwrap();
    fs::write(folder.path().join("thread-scaling.toml"), TINY).unwrap();
    finish(pathmark(folder.path(), &["run", "thread-scaling.toml"])).with_code(0);
    let judge = ["claims", "out", "--ledger", "paper.toml", "--json"];
    let told: serde_json::Value =
        serde_json::from_str(&finish(pathmark(folder.path(), &judge)).with_code(0).out).unwrap();
    let measured = told[0]["measured"].as_str().unwrap();
    let speedup: f64 = measured.split(' ').next().unwrap().parse().unwrap();
    assert!(speedup > 0.0 && measured.contains(" to "), "{told}");
}

/// Runs the commands of a document as printed, except that images are small and the simulation skips its check of this
/// machine. Returns their number.
fn run_all(folder: &Path, text: &str) -> usize {
    let mut commands = 0;
    for (language, block) in blocks(text) {
        match language {
            "toml" => {
                let name = block.lines().next().and_then(|line| line.strip_prefix("# ")).expect("a file's name");
                fs::write(folder.join(name), block).unwrap();
            }
            "sh" => {
                for line in block.lines() {
                    let small = line.replace("160x120", "40x30").replace("64x48", "16x12");
                    let mut words: Vec<&str> = small.split_whitespace().collect();
                    assert_eq!(words[0], "pathmark", "{line}");
                    match words[1] {
                        "run" => words.extend(["--set", "size=16x12"]),
                        "render" if !small.contains("--size") => words.extend(["--size", "64x48"]),
                        "simulate" => words.push("--no-check"),
                        // It measures for twenty seconds, whatever the size.
                        "doctor" => continue,
                        _ => (),
                    }
                    finish(pathmark(folder, &words[1..])).with_code(0);
                    commands += 1;
                }
            }
            other => panic!("a block in {other:?}"),
        }
    }
    commands
}

#[test]
fn every_command_of_the_lab_sheet_runs() {
    let folder = in_memory();
    assert!(run_all(folder.path(), include_str!("../../docs/course/lab.md")) > 8);
    for made in ["a.svg", "out/report.html", "out/lab/figures/losses.svg", "sizes/report.html"] {
        assert!(folder.path().join(made).is_file(), "{made}");
    }
}

#[test]
fn every_command_of_the_tutorial_runs() {
    let folder = in_memory();
    let commands = run_all(folder.path(), include_str!("../../docs/tutorial.md"));
    assert!(commands > 12, "{commands} commands");
    let made =
        ["blocks.svg", "out/report.html", "out/speedup/figures/speedup.svg", "draft.tex", "elsewhere/report.html"];
    for made in made {
        assert!(folder.path().join(made).is_file(), "{made}");
    }
    // The first three images of the tutorial are the same.
    let image = |name: &str| fs::read(folder.path().join(name)).unwrap();
    assert!(image("box.png") == image("one.png") && image("one.png") == image("four.png"));
}

/// The programs of docs/data.md draw a figure from rows. Each runs if its language and packages are installed.
#[test]
fn the_programs_that_read_rows_draw_a_figure() {
    let folder = in_memory();
    let probes = [
        ("python", "python3", ["-c", "import pandas, matplotlib"], ["program.py"]),
        ("r", "Rscript", ["-e", "0"], ["program.r"]),
    ];
    let (mut has_rows, text) = (false, include_str!("../../docs/data.md"));
    for (language, interpreter, probe, file) in probes {
        let run = |arguments: &[&str]| {
            Command::new(interpreter).args(arguments).env("MPLBACKEND", "Agg").current_dir(folder.path()).output()
        };
        let blocks: Vec<&str> = blocks(text).into_iter().filter(|(own, _)| *own == language).map(|(_, b)| b).collect();
        assert_eq!(blocks.len(), 1, "{language}");
        if !run(&probe).is_ok_and(|output| output.status.success()) {
            eprintln!("{interpreter} or its packages are missing: the program in docs/data.md is not run");
            continue;
        }
        if !has_rows {
            let small =
                "run thread-scaling --set size=64x48 --filter decomposition=tiles:16x16 --repetitions 3 --out out";
            finish(pathmark(folder.path(), &small.split_whitespace().collect::<Vec<_>>())).with_code(0);
            has_rows = true;
        }
        fs::write(folder.path().join(file[0]), blocks[0]).unwrap();
        let output = run(&file).unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
        assert!(told.contains("work-stealing") && told.contains("serial"), "{told}");
        let figure = folder.path().join("speedup.png");
        assert!(fs::metadata(&figure).unwrap().len() > 2000);
        fs::remove_file(figure).unwrap();
    }
}
