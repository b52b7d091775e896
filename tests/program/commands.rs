//! The commands in the documents run as printed there, with smaller images.

use crate::experiment::TINY;
use crate::faults::is_thorough;
use crate::program::{Finished, finish, in_memory, pathmark};
use crate::ranks::{has_launcher, launcher_named};
use std::collections::BTreeSet;
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The fenced blocks of a document in order, each with its language.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let mut parts = text.split("\n```");
    parts.next();
    // After each opening fence come the language and the block; after each closing fence, the text between blocks.
    parts.step_by(2).filter_map(|part| part.split_once('\n')).collect()
}

/// A reader with a shell, whose `pathmark` renders small images, and whose folder is `here`.
struct Reader {
    here: TempDir,
    /// The first folder of the path; not in memory, where programs may not run.
    programs: TempDir,
}

/// The program `pathmark` of a reader. `doctor` is left out, because it measures for twenty seconds at any size.
/// `simulate` does not first predict this machine, which takes fifteen seconds of renders; other tests do so. `diff` may
/// find a build slower than its copy, and `replicate` other times, because renders are so short here.
const SMALL: &str = r#"#!/bin/sh
has() { case " $words " in *" $1 "*) ;; *) return 1 ;; esac; }
words=$*
case $1 in
    doctor) exit ;;
    run)
        ! has thread-scaling || has --filter || set -- "$@" --filter strategy=serial,work-stealing,rayon
        set -- "$@" RUN
        ;;
    render) has --size || set -- "$@" --size RENDER ;;
    inspect) if has rays || has --pixel; then has --size || set -- "$@" --size RENDER; fi ;;
    price) has --size || set -- "$@" --size 32x24 ;;
    simulate) set -- "$@" --no-check ;;
    bursts) set -- "$@" --regions 2 --rounds 1 --processes 3 ;;
    diff | replicate) 'PROGRAM' "$@" || [ $? = 1 ]; exit ;;
esac
exec 'PROGRAM' "$@"
"#;

/// Sizes and durations of the documents, and smaller ones.
const SMALLER: [(&str, &str); 11] = [
    ("8192x8192", "32x24"),
    ("1280x720", "32x18"),
    ("512x384", "32x24"),
    ("256x192", "32x24"),
    ("160x120", "40x30"),
    ("64x48", "16x12"),
    ("--shard 1/4", "--shard 1/2"),
    ("--shard 2/4", "--shard 2/2"),
    ("--repetitions 15", "--repetitions 2"),
    ("--max-time 2min", "--max-time 1s"),
    ("--max-time 10s", "--max-time 1s"),
];

impl Reader {
    /// `run`: more arguments of each sweep. `render`: the size of an image that has none.
    fn new(run: &str, render: &str) -> Self {
        let (here, programs) = (in_memory(), tempfile::tempdir().unwrap());
        let program = assert_cmd::cargo::cargo_bin!("pathmark").display().to_string();
        let small = SMALL.replace("PROGRAM", &program).replace("RUN", run).replace("RENDER", render);
        let path = programs.path().join("pathmark");
        fs::write(&path, small).unwrap();
        fs::set_permissions(&path, Permissions::from_mode(0o755)).unwrap();
        Self { here, programs }
    }

    fn path(&self) -> &Path {
        self.here.path()
    }

    /// Runs the lines as a script that ends at the first error.
    fn run(&self, lines: &str) -> Finished {
        let small = SMALLER.iter().fold(lines.to_owned(), |text, (from, to)| text.replace(from, to));
        let mut command = launcher_named("sh", self.path());
        let path = std::env::var("PATH").unwrap_or_default();
        command.args(["-e", "-c", &small]).env("PATH", format!("{}:{path}", self.programs.path().display()));
        finish(command).with_code(0)
    }

    /// Runs all commands of a document, and writes its definitions. Returns the number of commands.
    fn follow(&self, text: &str) -> usize {
        let mut commands = 0;
        for (language, block) in blocks(text) {
            match language {
                "toml" => {
                    let name = block.lines().next().and_then(|line| line.strip_prefix("# ")).expect("a file's name");
                    fs::write(self.path().join(name), block).unwrap();
                }
                "sh" => {
                    self.run(block);
                    commands += count(block);
                }
                other => panic!("a block in {other:?}"),
            }
        }
        commands
    }
}

fn count(block: &str) -> usize {
    block.lines().filter(|line| line.starts_with("pathmark ") || line.starts_with("mpiexec ")).count()
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
    let reader = Reader::new("--set size=32x24 --repetitions 1", "128x201");
    let text = include_str!("../../README.md");
    let lines = blocks(text).into_iter().filter(|(language, _)| *language == "sh").flat_map(|(_, block)| block.lines());
    let own = lines.filter(|line| line.starts_with("pathmark ") && !ELSEWHERE.iter().any(|own| line.starts_with(own)));
    let script: Vec<&str> = own.collect();
    reader.run(&script.join("\n"));
    assert!(script.len() > 10, "{script:?}");
}

/// Manuals and notes. Each has a folder with rows and a ledger, and another build beside it.
#[test]
fn every_command_of_manuals_and_notes_runs() {
    // These have tests of their own; that of `rubric.md` is in tests/grade.
    const ELSEWHERE: [&str; 4] = ["tutorial.md", "lab.md", "rubric.md", "external.md"];
    let mut commands = 0;
    for page in pages() {
        let (text, name) = (fs::read_to_string(&page).unwrap(), page.file_name().unwrap().to_str().unwrap());
        let shell: Vec<&str> = blocks(&text).into_iter().filter(|(own, _)| *own == "sh").map(|(_, b)| b).collect();
        if ELSEWHERE.contains(&name) || shell.is_empty() {
            continue;
        }
        let reader = Reader::new("--set size=16x12", "64x48");
        let old = reader.programs.path().join("old/target/release");
        fs::create_dir_all(&old).unwrap();
        fs::copy(reader.programs.path().join("pathmark"), old.join("pathmark")).unwrap();
        let folder = reader.programs.path().display();
        if name == "artifacts.md" {
            fs::write(reader.path().join("tiny.toml"), TINY).unwrap();
            fs::write(reader.path().join("paper.toml"), crate::artifact::ledger()).unwrap();
            reader.run("pathmark run tiny.toml");
        }
        for block in shell {
            // The notes on repetitions have a table of these. One pool needs a compiler of C++.
            let block = block
                .replace("OPTIONS", "--repetitions 2")
                .replace(",forkunion", "")
                .replace("../old/", &format!("{folder}/old/"));
            if !block.contains("mpiexec") || has_launcher() {
                reader.run(&block.replace("--nodes 2..64", "--nodes 2..4"));
            }
            commands += count(&block);
            // The blocks of these pages stand alone, and no sweep overwrites another one.
            let _ = fs::remove_dir_all(reader.path().join("out"));
        }
    }
    assert!(commands > 18, "{commands} commands");
}

fn pages() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["docs", "docs/course", "docs/notes"].map(|folder| fs::read_dir(root.join(folder)).unwrap());
    let mut pages: Vec<PathBuf> = folders.into_iter().flatten().map(|entry| entry.unwrap().path()).collect();
    pages.retain(|path| path.extension().is_some_and(|end| end == "md"));
    pages.sort();
    pages
}

/// Words that stand for something in a sentence's command, and what they stand for here.
const MEANT: [(&str, &str); 5] = [
    ("SCENE", "bumpy-ball:500"),
    ("bumpy-ball:N", "bumpy-ball:500"),
    ("E", "0.5"),
    ("S", "sobol"),
    ("FOLDER...", "DIR"),
];

/// Verbs whose commands within sentences are only read. Studies and self-tests take minutes to hours; other tests run
/// them in small. `grade` and `artifact` need a folder that tests of their own make. A thorough test runs experiments.
const ONLY_READ: [&str; 7] = ["run", "reproduce", "selftest", "simulate", "doctor", "grade", "artifact"];

/// Commands within sentences: the program understands their verb, options, values and names, and all but
/// [`ONLY_READ`] run.
#[test]
fn the_commands_within_sentences_run() {
    // Tests of archives have the rows of one, and those of `equal-time` have pictures.
    const ELSEWHERE: [&[&str]; 2] = [&["replicate", "DIR/rows/RUN"], &["report", "out", "--crops", "20,10,32"]];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let others = ["README.md", "results/README.md", "examples/ledgers/README.md"].map(|name| root.join(name));
    let texts: Vec<String> = pages().into_iter().chain(others).map(|page| fs::read_to_string(page).unwrap()).collect();
    let is_command =
        |code: &&str| code.starts_with("pathmark ") && !["VERB", "KIND"].iter().any(|any| code.contains(any));
    let commands: BTreeSet<Vec<&str>> = texts
        .iter()
        .flat_map(|text| text.split('`').filter(is_command))
        .map(|command| command.split_whitespace().skip(1).map(meant).collect())
        .collect();
    assert!(commands.len() > 50, "{commands:?}");

    let reader = Reader::new("--set size=16x12", "32x24");
    let known = reader.run("pathmark list experiments").out;
    // A verb alone is its name, and so is that of a part of `inspect` or `new`.
    let is_name = |words: &[&str]| match words {
        ["list" | "machine"] => false,
        [_] | ["inspect" | "new", _] => true,
        _ => false,
    };
    let is_read = |words: &[&str]| is_name(words) || ONLY_READ.contains(&words[0]) || ELSEWHERE.contains(&words);
    let (read, run): (Vec<_>, Vec<_>) = commands.iter().partition(|words| is_read(words));
    for words in read {
        reader.run(&format!("pathmark {} --help", words.join(" ")));
        if let ["run", experiment, ..] = words[..] {
            let is_known = known.lines().any(|line| line.split_whitespace().next() == Some(experiment));
            assert!(is_known || experiment == "NAME", "{words:?}");
            if is_known && is_thorough() {
                let reader = Reader::new("--set size=16x12 --repetitions 1", "32x24");
                reader.run(&format!("pathmark {}", words.join(" ")));
            }
        }
    }

    // Rows for the commands that read some: of a sweep, and of a class of two.
    fs::write(reader.path().join("thread-scaling.toml"), TINY).unwrap();
    fs::write(reader.path().join("my-paper.toml"), crate::artifact::ledger()).unwrap();
    std::os::unix::fs::symlink(root.join("results"), reader.path().join("results")).unwrap();
    reader.run("pathmark run thread-scaling.toml; cp -r out/thread-scaling DIR; mkdir class; cp -r out class/ada");
    reader.run("cp -r out class/ben");
    reader.run("pathmark render cornell --spp 4 -o OURS.pfm; cp OURS.pfm THEIRS.pfm");
    // Other commands use the files that `new` makes.
    let (made, used): (Vec<_>, Vec<_>) = run.into_iter().partition(|words| words[0] == "new");
    for words in made.iter().chain(&used) {
        reader.run(&format!("pathmark {}", words.join(" ")));
    }
    assert!(made.len() > 2 && used.len() > 20, "{made:?} {used:?}");
}

fn meant(word: &str) -> &str {
    MEANT.iter().find(|(stands, _)| *stands == word).map_or(word, |(_, meaning)| *meaning)
}

/// The script of the notes on regressions, in a repository of two commits. A stand-in for `cargo` puts this program
/// into both folders, because compiling it twice takes minutes.
#[test]
fn the_script_of_the_notes_compares_two_commits() {
    let reader = Reader::new("--set size=16x12", "64x48");
    let text = include_str!("../../docs/notes/regressions.md");
    let script = blocks(text).into_iter().find_map(|(language, block)| (language == "bash").then_some(block));
    let programs = reader.programs.path().display();
    let cargo = reader.programs.path().join("cargo");
    let compiles = format!(
        "#!/bin/sh\n[ \"$*\" = 'build --release' ]\nmkdir -p target/release\ncp {programs}/pathmark target/release\n"
    );
    fs::write(&cargo, compiles).unwrap();
    fs::set_permissions(&cargo, Permissions::from_mode(0o755)).unwrap();
    let commit = "git -c user.name=Ada -c user.email=ada@example.org commit -q --allow-empty -m";
    let finished = reader.run(&format!(
        "mkdir {programs}/new && cd {programs}/new && git init -q && {commit} old && {commit} new; BASE=HEAD~1\n{}",
        script.expect("the script")
    ));
    assert!(finished.out.contains("work-stealing"), "{}", finished.out);
    assert!(reader.programs.path().join("old/.git").is_file(), "a work tree of the commit before");
}

/// The two commands that compare with Mitsuba. They run if Python has Mitsuba (`.ci/install` installs it): `pip` then
/// installs two packages that only lead to the one that is there, so no test needs a network.
#[test]
fn the_commands_for_mitsuba_run() {
    const PACKAGES: &str = r"
import ensurepip, os, zipfile, mitsuba, numpy
for package in (mitsuba, numpy):
    name = package.__name__
    with zipfile.ZipFile(f'{name}-1-py3-none-any.whl', 'w') as wheel:
        wheel.writestr(f'{name}.pth', os.path.dirname(os.path.dirname(package.__file__)))
        wheel.writestr(f'{name}-1.dist-info/METADATA', f'Metadata-Version: 2.1\nName: {name}\nVersion: 1\n')
        wheel.writestr(f'{name}-1.dist-info/WHEEL', 'Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n')
        wheel.writestr(f'{name}-1.dist-info/RECORD', '')
";
    let reader = Reader::new("--set size=16x16", "64x48");
    let folder = reader.programs.path();
    let mut packages = Command::new("python3");
    packages.args(["-c", PACKAGES]).current_dir(folder);
    if !packages.output().is_ok_and(|output| output.status.success()) {
        eprintln!("Python, its venv or Mitsuba is missing: the commands in docs/external.md are not run");
        return;
    }
    let root = env!("CARGO_MANIFEST_DIR");
    let text = include_str!("../../docs/external.md");
    let script = blocks(text).into_iter().find_map(|(language, block)| (language == "sh").then_some(block));
    let offline =
        format!("export PIP_NO_INDEX=1 PIP_FIND_LINKS={0} PIP_DISABLE_PIP_VERSION_CHECK=1; cd {0}", folder.display());
    // One small image instead of eighteen larger ones, and a reference to match.
    let few = "sed -i -e 's/= .4, 16, 64./= [4]/; s/= .1, 2, 3, 4, 5, 6./= [1]/; s/96, 96/16, 16/; s/1024/64/' \
               experiments/peers/mitsuba.toml";
    let finished = reader.run(&format!(
        "{offline}; mkdir -p experiments/peers; cp {root}/experiments/peers/mitsuba* experiments/peers; {few}\n{}",
        script.expect("the commands")
    ));
    let rows = fs::read_to_string(folder.join("out/mitsuba/records.csv")).unwrap();
    assert_eq!(rows.lines().filter(|row| row.contains("/mitsuba")).count(), 1, "{rows}\n{}", finished.out);
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

#[test]
fn every_command_of_the_lab_sheet_runs() {
    let reader = Reader::new("--set size=16x12", "64x48");
    assert!(reader.follow(include_str!("../../docs/course/lab.md")) > 8);
    for made in ["a.svg", "out/report.html", "out/lab/figures/losses.svg", "sizes/report.html"] {
        assert!(reader.path().join(made).is_file(), "{made}");
    }
}

#[test]
fn every_command_of_the_tutorial_runs() {
    let reader = Reader::new("--set size=16x12", "64x48");
    let commands = reader.follow(include_str!("../../docs/tutorial.md"));
    assert!(commands > 12, "{commands} commands");
    let made =
        ["blocks.svg", "out/report.html", "out/speedup/figures/speedup.svg", "draft.tex", "elsewhere/report.html"];
    for made in made {
        assert!(reader.path().join(made).is_file(), "{made}");
    }
    // The first three images of the tutorial are the same.
    let image = |name: &str| fs::read(reader.path().join(name)).unwrap();
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
                "run thread-scaling --set size=64x48 --filter decomposition=tiles:8x8 --repetitions 3 --out out";
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
