//! `pathmark artifact`: an archive from which others judge the claims and measure the rows again, and its check.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use crate::snapshot::{assert_untouched, snapshot};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::ffi::OsString;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// Three claims on the rows of [`TINY`], which has 4 samples per pixel: one is true, one is false, and one has no rows.
pub(crate) fn ledger() -> String {
    let claim = |id: u32, rest: &str| {
        format!(
            "\n[[claim]]\nid = {id}\nquote = \"q\"\nplace = \"page 1\"\nreported = \"4\"\nclaim = \"Claim {id}.\"\n\
             frozen = \"2026-01-31T12:00:00Z\"\nexpected = \"confirmed\"\n{rest}"
        )
    };
    let value = "experiment = \"tiny\"\nstatistic = \"value\"\ncolumn = \"spp\"\nlevel = 0.95\nreason = \"r\"\n";
    let missing = claim(1, "missing = \"Nobody measured it.\"\n");
    let (right, wrong) = (claim(2, &format!("{value}within = [4, 4]\n")), claim(3, &format!("{value}at-least = 5\n")));
    format!("report = \"T\"\ntitle = \"A test\"\nabout = \"Invented.\"\n{missing}{right}{wrong}")
}

/// A folder whose `out` has rows, beside a ledger.
fn with_rows(definition: &str) -> TempDir {
    let folder = in_memory();
    write_tiny(folder.path(), definition);
    fs::write(folder.path().join("paper.toml"), ledger()).unwrap();
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    folder
}

const MAKE: [&str; 11] = [
    "artifact",
    "made",
    "out",
    "--ledger",
    "paper.toml",
    "--title",
    "Rows: a \"test\"",
    "--author",
    "Carberry, Josiah <0000-0002-1825-0097>",
    "--license",
    "CC-BY-4.0",
];

/// Copies a folder, as unpacking an archive would.
fn unpack(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(Result::unwrap) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            unpack(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs a script of an archive in another folder, with the program in its path.
fn script(archive: &Path, name: &str, arguments: &[&str]) -> Output {
    let program = assert_cmd::cargo::cargo_bin!("pathmark");
    let mut path = OsString::from(program.parent().unwrap());
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    Command::new("sh").arg(archive.join(name)).args(arguments).current_dir("/").env("PATH", path).output().unwrap()
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Python's libraries for crates and citations judge the archive, where they are installed.
fn validate(archive: &Path) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/artifact/validate.py");
    match Command::new("python3").arg(script).arg(archive).output() {
        Err(_) => eprintln!("python3 is missing: nothing is validated by its libraries"),
        Ok(output) => {
            assert!(output.status.success(), "{}", said(&output));
            println!("{}", said(&output));
        }
    }
}

/// In a clean folder, one command judges the first claim that has rows, and another one measures it again.
#[test]
fn the_first_claim_runs_in_a_clean_folder() {
    let folder = with_rows(TINY);
    let told = finish(pathmark(folder.path(), &MAKE)).with_code(0).out;
    assert!(told.contains("pathmark artifact made --check") && told.contains("tar -czf made.tar.gz made"), "{told}");
    let clean = in_memory();
    let archive = clean.path().join("unpacked here");
    unpack(&folder.path().join("made"), &archive);
    drop(folder);

    let before = snapshot(&archive);
    let first = script(&archive, "first-claim.sh", &[]);
    assert!(first.status.success(), "{}", said(&first));
    assert!(said(&first).contains("claim 2: confirmed, as stated; measured 4, predicted 4"), "{}", said(&first));
    assert!(!said(&first).contains("claim 3"), "{}", said(&first));
    let checked = finish(pathmark(&archive, &["artifact", ".", "--check"])).with_code(0).out;
    for told in ["claim 1: not answered, as stated: Claim 1.", "claim 3: refuted", "rows of 1 experiment"] {
        assert!(checked.contains(told), "{checked}");
    }
    assert_untouched(&before, &snapshot(&archive));

    let again = clean.path().join("again");
    let measured = script(&archive, "measure-first-claim.sh", &[again.to_str().unwrap()]);
    assert!(measured.status.success(), "{}", said(&measured));
    assert!(said(&measured).contains("2 T  confirmed"), "{}", said(&measured));
    assert!(again.join("tiny/records.csv").is_file());
    assert_untouched(&before, &snapshot(&archive));
    validate(&archive);
}

/// The appendix and the container are filled from the plan, the machine and the rows.
#[test]
fn the_appendix_tells_what_each_claim_takes() {
    let folder = with_rows(TINY);
    finish(pathmark(folder.path(), &MAKE)).with_code(0);
    let read = |name: &str| fs::read_to_string(folder.path().join("made").join(name)).unwrap();
    let (readme, container) = (read("README.md"), read("Containerfile"));
    let machine: toml::Table = read("rows/out/tiny/machine.toml").parse().unwrap();
    let fact = |name: &str| machine["machine"][name].as_str().unwrap();
    for told in [
        "# Rows: a \"test\"",
        "Josiah Carberry",
        "Licence: CC-BY-4.0",
        "3 claims (A test)",
        "1 confirmed, 1 refuted, 1 not answered",
        "### 2. Claim 2.\n\n* **Verdict:** confirmed\n* **Measured:** 4; predicted: 4\n",
        "`pathmark artifact . --check --claim 2`",
        "`pathmark replicate rows/out/tiny --out ../again`; ",
        " for the experiment\n",
        "* **Time to prepare:** not measured; ",
        " s, estimated by a pilot on ",
        "No rows here answer these claims: 1.",
        "sh first-claim.sh",
        "sh measure-first-claim.sh ../again",
        fact("cpu"),
        fact("rustc"),
        fact("system"),
    ] {
        assert!(readme.contains(told), "{told}\n{readme}");
    }
    assert!(container.contains(&format!("ARG COMMIT={}\n", fact("commit"))), "{container}");
    let rust = fact("rustc").split(' ').nth(1).unwrap();
    assert!(container.contains(&format!("ARG RUST={rust}\n")), "{container}");
    assert!(container.contains("FROM docker.io/library/debian:13.8-slim\n"), "{container}");
    assert!(container.ends_with("CMD [\"sh\", \"first-claim.sh\"]\n"), "{container}");
    // No address that does not exist is cloned.
    assert!(container.contains("has not built it") && !container.contains(".invalid"), "{container}");
    assert!(!readme.contains(".invalid") && !read("ro-crate-metadata.json").contains(".invalid"), "{readme}");
    assert!(read("CITATION.cff").contains("orcid: \"https://orcid.org/0000-0002-1825-0097\""));
    assert!(read("CLAIMS.md").contains("(rows/out/tiny/records.csv)"), "{}", read("CLAIMS.md"));
    assert!(read("claims.csv").contains(",rows/out/tiny/records.csv,"), "{}", read("claims.csv"));
}

/// An executable that was renamed writes the name that `cargo install` gives.
#[test]
fn scripts_call_the_program_by_its_installed_name() {
    let folder = with_rows(TINY);
    // Not in memory, where programs may not be run.
    let programs = tempfile::tempdir().unwrap();
    let renamed = programs.path().join("pm");
    fs::copy(assert_cmd::cargo::cargo_bin!("pathmark"), &renamed).unwrap();
    let output = Command::new(&renamed).args(MAKE).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", said(&output));
    let archive = folder.path().join("made");
    let first = script(&archive, "first-claim.sh", &[]);
    assert!(first.status.success(), "{}", said(&first));
    for name in ["README.md", "Containerfile", "first-claim.sh", "measure-first-claim.sh"] {
        let text = fs::read_to_string(archive.join(name)).unwrap();
        assert!(!text.split(|char: char| !char.is_alphanumeric()).any(|word| word == "pm"), "{name}: {text}");
    }
}

/// A ledger on the rows of another program: the appendix tells its command and costs, and nothing of experiments.
#[test]
fn rows_of_other_programs_have_their_own_appendix() {
    let folder = in_memory();
    fs::create_dir(folder.path().join("out")).unwrap();
    let rows = |unit: f64| ["0", "1", "2", "3"].map(|run| format!("quick,{run},{unit}\n")).concat();
    fs::write(folder.path().join("out/times.csv"), format!("program,repetition,spp\n{}", rows(4.0))).unwrap();
    let table = "[[table]]\nname = \"tiny\"\nfile = \"times.csv\"\nsettings = [\"program\"]\nvalues = [\"spp\"]\n";
    let costs = "command = \"sh measure.sh\"\nseconds = 400.0\nbytes = 2000000\nmachine = \"a Cray-1\"\n";
    let told = |costs: &str| {
        let text = ledger().replace("about = \"Invented.\"\n", &format!("about = \"Invented.\"\n{table}{costs}"));
        fs::write(folder.path().join("paper.toml"), text).unwrap();
        let _ = fs::remove_dir_all(folder.path().join("made"));
        finish(pathmark(folder.path(), &MAKE)).with_code(0);
        let checked = finish(pathmark(folder.path(), &["artifact", "made", "--check"])).with_code(0).out;
        assert!(checked.contains("rows of 1 table of another program, all verdicts"), "{checked}");
        assert!(!folder.path().join("made/measure-first-claim.sh").exists());
        fs::read_to_string(folder.path().join("made/README.md")).unwrap()
    };
    let readme = told(costs);
    for told in [
        "Measured rows of 1 table of another program, ",
        "* **Hardware:** a Cray-1\n",
        "about 2.0 MB for new rows\n",
        "* **Time to measure all rows again:** 400 s for rows of other programs, as the ledger tells\n",
        "* **Measure again:** `sh measure.sh` writes `times.csv`; 400 s, 2.0 MB, on a Cray-1, as the ledger tells\n",
        "## Rows of other programs\n\n* `rows/out/times.csv`: `sh measure.sh` writes ",
    ] {
        assert!(readme.contains(told), "{told}\n{readme}");
    }
    for wrong in
        ["pilot", "0 experiment", "report.html", "experiment.toml", "measures the rows again", "## Experiments"]
    {
        assert!(!readme.contains(wrong), "{wrong}\n{readme}");
    }
    let readme = told("");
    assert!(readme.contains("rows again:** unknown for 1 table of other programs\n"), "{readme}");
    assert!(readme.contains("another program wrote `times.csv`; the ledger names no command"), "{readme}");
}

/// Without `--ledger` the archive has the program's own ledgers, and its check finds the same words.
#[test]
fn the_programs_own_ledgers_pass_the_check() {
    let folder = in_memory();
    let rows = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/seeds-2").display().to_string();
    finish(pathmark(folder.path(), &["artifact", "made", &rows, "--title", "Seeds", "--author", "Ada Lovelace"]))
        .with_code(0);
    let checked = finish(pathmark(folder.path(), &["artifact", "made", "--check"])).with_code(0).out;
    assert!(checked.contains("claim 26: confirmed, as stated"), "{checked}");
}

/// A claim about a forecast is judged by traces and calibrations, so they come along.
#[test]
fn a_claim_about_a_forecast_keeps_its_verdict() {
    let folder = in_memory();
    let rows = Path::new(env!("CARGO_MANIFEST_DIR")).join("results/reports-2/scaling-forecast");
    fs::create_dir(folder.path().join("out")).unwrap();
    unpack(&rows, &folder.path().join("out/scaling-forecast"));
    fs::write(folder.path().join("out/scaling-forecast/traces/of-no-row.csv"), "").unwrap();
    finish(pathmark(folder.path(), &["artifact", "made", "out"])).with_code(0);
    let made = folder.path().join("made");
    let traces = fs::read_dir(made.join("rows/out/scaling-forecast/traces")).unwrap().count();
    assert_eq!(traces, 6, "those of the serial rows, and no others");
    let checked = finish(pathmark(&made, &["artifact", ".", "--check"])).with_code(0).out;
    assert!(checked.contains("claim 7: refuted, as stated"), "{checked}");
}

/// Packed rows are taken as they are, a missing page is drawn, scene files come along, and missing names are named so.
#[test]
fn packed_rows_pages_and_scenes_come_along() {
    let folder = in_memory();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    fs::write(folder.path().join("scenes/mine.toml"), "about = 'mine'\nbase = 'cornell'\n").unwrap();
    write_tiny(folder.path(), &TINY.replace("\"cornell\"", "\"scenes/mine.toml\""));
    fs::write(folder.path().join("paper.toml"), ledger()).unwrap();
    finish(pathmark(folder.path(), &["run", "tiny.toml", "--out", "out"])).with_code(0);
    fs::remove_file(folder.path().join("out/report.html")).unwrap();
    let rows = folder.path().join("out/tiny/records.csv");
    let packs = Command::new("gzip").arg(&rows).status().is_ok_and(|status| status.success());
    finish(pathmark(folder.path(), &["artifact", "made", "--ledger", "paper.toml"])).with_code(0);
    let made = folder.path().join("made");
    let name = if packs { "records.csv.gz" } else { "records.csv" };
    for file in ["scenes/mine.toml", "rows/out/report.html", &format!("rows/out/tiny/{name}")] {
        assert!(made.join(file).is_file(), "{file}");
    }
    finish(pathmark(folder.path(), &["artifact", "made", "--check"])).with_code(0);
    let readme = fs::read_to_string(made.join("README.md")).unwrap();
    assert!(
        readme.starts_with("# Unknown title\n\nUnknown author, ") && readme.contains("Licence: unknown"),
        "{readme}"
    );
    validate(&made);
}

/// Writes a file of an archive, and its new size and checksum into the list.
fn relist(archive: &Path, name: &str, text: &str) {
    fs::write(archive.join(name), text).unwrap();
    let path = archive.join("ro-crate-metadata.json");
    let mut list: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let entities = list["@graph"].as_array_mut().unwrap();
    let own = entities.iter_mut().find(|entity| entity["@id"] == name && entity["@type"] == "File").unwrap();
    let digest: Vec<String> = Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect();
    own["sha256"] = digest.concat().into();
    own["contentSize"] = text.len().to_string().into();
    fs::write(path, format!("{list:#}\n")).unwrap();
}

/// A name, the damage to an archive, and the words of its check.
type Fault = (&'static str, fn(&Path), &'static [&'static str]);

/// Changes a file and its line in the list, so that only its content is wrong.
fn edit(archive: &Path, name: &str, change: impl Fn(&str) -> String) {
    let text = fs::read_to_string(archive.join(name)).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed, "{name}");
    relist(archive, name, &changed);
}

const ROWS: &str = "rows/out/tiny/records.csv";

const FAULTS: &[Fault] = &[
    (
        "a changed byte",
        |archive| {
            let mut bytes = fs::read(archive.join(ROWS)).unwrap();
            let middle = bytes.len() / 2;
            bytes[middle] ^= 1;
            fs::write(archive.join(ROWS), bytes).unwrap();
        },
        &["ro-crate-metadata.json:", ": sha256 = ", ROWS],
    ),
    (
        "a longer file",
        |archive| {
            let text = fs::read_to_string(archive.join("README.md")).unwrap();
            fs::write(archive.join("README.md"), text + "\n").unwrap();
        },
        &["ro-crate-metadata.json:", ": contentSize = ", "README.md has "],
    ),
    (
        "a missing file",
        |archive| fs::remove_file(archive.join("rows/out/tiny/machine.toml")).unwrap(),
        &["ro-crate-metadata.json:", "@id = rows/out/tiny/machine.toml: there is no such file"],
    ),
    (
        "an extra file",
        |archive| fs::write(archive.join("rows/extra.csv"), "").unwrap(),
        &["rows/extra.csv", "is not listed in ro-crate-metadata.json"],
    ),
    (
        "a link",
        |archive| symlink("/etc/passwd", archive.join("rows/link")).unwrap(),
        &["rows/link", "neither a file nor a folder"],
    ),
    (
        "a list that is a link",
        |archive| {
            fs::remove_file(archive.join("ro-crate-metadata.json")).unwrap();
            symlink("/etc/passwd", archive.join("ro-crate-metadata.json")).unwrap();
        },
        &["ro-crate-metadata.json", "neither a file nor a folder"],
    ),
    (
        "broken JSON",
        |archive| {
            let path = archive.join("ro-crate-metadata.json");
            let text = fs::read_to_string(&path).unwrap();
            fs::write(path, text.replacen("\"@graph\"", "\"@graph", 1)).unwrap();
        },
        &["ro-crate-metadata.json:", "JSON: cannot be read"],
    ),
    (
        "no list",
        |archive| fs::remove_file(archive.join("ro-crate-metadata.json")).unwrap(),
        &["ro-crate-metadata.json", "there is no such file"],
    ),
    (
        "a wrong citation",
        |archive| edit(archive, "CITATION.cff", |text| text.replace("0097", "0098")),
        &["CITATION.cff:8:12: orcid = "],
    ),
    (
        "a wrong row",
        |archive| edit(archive, ROWS, |text| text.replacen(",24,16,", ",wide,16,", 1)),
        &["records.csv:2:1: width: cannot be read"],
    ),
    (
        "a verdict that the rows do not give",
        |archive| edit(archive, "claims.csv", |text| text.replacen("confirmed", "refuted", 1)),
        &["claims.csv:3:1: verdict = refuted: claim 2: the rows give confirmed"],
    ),
    (
        "a value that the rows do not give",
        |archive| edit(archive, "claims.csv", |text| text.replacen(",confirmed,4,", ",confirmed,3,", 1)),
        &["claims.csv:3:1: measured = 3: claim 2: the rows give 4"],
    ),
    (
        "another bound",
        |archive| edit(archive, "ledger/paper.toml", |text| text.replace("at-least = 5", "at-least = 4")),
        &["claims.csv:4:1: verdict = refuted: claim 3: the rows give confirmed"],
    ),
    (
        "a claim without a verdict",
        |archive| edit(archive, "claims.csv", |text| text.split_inclusive('\n').take(3).collect()),
        &["claims.csv: claim = 3: is in the ledger, and has no line here"],
    ),
    (
        "a verdict without a claim",
        |archive| edit(archive, "claims.csv", |text| format!("{text}7{}\n", &text.lines().last().unwrap()[1..])),
        &["claims.csv:5:1: claim = 7: is not in the ledger"],
    ),
    (
        "a bound that the ledger does not have",
        |archive| edit(archive, "claims.csv", |text| text.replacen("at least 5", "at least 4", 1)),
        &["claims.csv:4:1: predicted = at least 4: claim 3: the rows give at least 5"],
    ),
    (
        "another rule",
        |archive| edit(archive, "claims.csv", |text| text.replacen("repetition", "seed", 1)),
        &["claims.csv:3:1: rule = "],
    ),
    (
        "other runs",
        |archive| edit(archive, "claims.csv", |text| text.replacen("in 1 of 1 run", "in 2 of 2 runs", 1)),
        &["claims.csv:3:1: runs = in 2 of 2 runs"],
    ),
    (
        "other rows",
        |archive| edit(archive, "claims.csv", |text| text.replacen("rows/out/tiny/", "rows/in/tiny/", 1)),
        &["claims.csv:3:1: rows = rows/in/tiny/records.csv"],
    ),
    (
        "another sentence",
        |archive| edit(archive, "claims.csv", |text| text.replacen("Claim 1.", "Claim one.", 1)),
        &["claims.csv:2:1: says = Claim one.: claim 1: "],
    ),
    (
        "a text with another verdict",
        |archive| edit(archive, "CLAIMS.md", |text| text.replacen("**Refuted**", "**Confirmed**", 1)),
        &["CLAIMS.md:", "line = **Confirmed**, in 1 of 1 run: ", "writes: **Refuted**"],
    ),
    (
        "a text that ends early",
        |archive| edit(archive, "CLAIMS.md", |text| text.lines().next().unwrap().to_string()),
        &["CLAIMS.md:2:1: line: "],
    ),
    (
        "no version of RO-Crate",
        |archive| strip(archive, "ro-crate-metadata.json", "conformsTo"),
        &["ro-crate-metadata.json:", ": conformsTo: "],
    ),
    ("no date", |archive| strip(archive, "./", "datePublished"), &["ro-crate-metadata.json:", ": datePublished: "]),
    ("no parts", |archive| strip(archive, "./", "hasPart"), &["ro-crate-metadata.json:", ": hasPart: "]),
    (
        "a table outside",
        |archive| ask_for(archive, "/etc/passwd"),
        &["ledger/paper.toml:6:8: file = /etc/passwd: leads out of the archive", "without `..`"],
    ),
    (
        "a table above",
        |archive| ask_for(archive, "../../../secret.csv"),
        &["ledger/paper.toml:6:8: file = ../../../secret.csv: leads out of the archive"],
    ),
    (
        "an experiment above",
        |archive| edit(archive, "ledger/paper.toml", |text| text.replace("\"tiny\"", "\"../../../out/tiny\"")),
        &["ledger/paper.toml:", "experiment = ../../../out/tiny: leads out of the archive"],
    ),
    (
        "an experiment outside",
        |archive| edit(archive, "ledger/paper.toml", |text| text.replacen("\"tiny\"", "\"/etc\"", 1)),
        &["ledger/paper.toml:", "experiment = /etc: leads out of the archive"],
    ),
];

/// Makes the claims ask for a table in this file.
fn ask_for(archive: &Path, file: &str) {
    let table = format!("[[table]]\nname = \"tiny\"\nfile = \"{file}\"\nsettings = [\"a\"]\nvalues = [\"spp\"]\n");
    edit(archive, "ledger/paper.toml", |text| text.replacen("\n[[claim]]", &format!("{table}\n[[claim]]"), 1));
}

/// Removes a property of an entity of the list.
fn strip(archive: &Path, id: &str, key: &str) {
    let path = archive.join("ro-crate-metadata.json");
    let mut list: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let entities = list["@graph"].as_array_mut().unwrap();
    let own = entities.iter_mut().find(|entity| entity["@id"] == id).unwrap();
    assert!(own.as_object_mut().unwrap().remove(key).is_some(), "{key}");
    fs::write(path, format!("{list:#}\n")).unwrap();
}

/// Every fault is told with file and field, and with the line where there is one.
#[test]
fn a_bad_archive_is_told_by_its_fault() {
    let folder = with_rows(TINY);
    finish(pathmark(folder.path(), &MAKE)).with_code(0);
    fs::write(folder.path().join("secret.csv"), "secrecy,repetition\n").unwrap();
    for (name, damage, told) in FAULTS {
        let archive = folder.path().join("bad");
        unpack(&folder.path().join("made"), &archive);
        damage(&archive);
        let error = finish(pathmark(folder.path(), &["artifact", "bad", "--check"])).with_code(2).err;
        assert!(told.iter().all(|told| error.contains(told)), "{name}: {error}");
        // Nothing of a file outside is told.
        assert!(!error.contains("root:") && !error.contains("secrecy"), "{name}: {error}");
        fs::remove_dir_all(archive).unwrap();
    }
    let error = finish(pathmark(folder.path(), &["artifact", "made", "--check", "--claim", "9"])).with_code(2).err;
    assert!(error.contains("claim = 9") && error.contains("1, 2, 3"), "{error}");
}

/// Nothing is overwritten, and wrong input makes no folder.
#[test]
fn wrong_input_is_refused_and_leaves_no_file() {
    let folder = with_rows(TINY);
    fs::create_dir(folder.path().join("full")).unwrap();
    fs::write(folder.path().join("full/notes.txt"), "mine").unwrap();
    fs::create_dir(folder.path().join("empty")).unwrap();
    fs::write(folder.path().join("CITATION.cff"), "cff-version: 1.2.0\nmessage: m\ntitle: [T]\n").unwrap();
    let names = ["--title", "T", "--author", "A", "--license", "MIT"];
    let before = snapshot(folder.path());
    for (arguments, told) in [
        (&["full", "out"][..], "archive = full: is not empty"),
        (&["paper.toml/new", "out"], "paper.toml/new"),
        (&["new", "nowhere"], "folder = nowhere: there is no such folder"),
        (&["new", "out/tiny"], "the folder above it, out"),
        (&["new", "empty"], "has no claim that the rows"),
        (&["new", "out", "--author", "Carberry, Josiah <0000-0002-1825-0098>"], "author = Carberry"),
        (&["new", "out", "--license", "my own"], "license = my own"),
        (&["nowhere", "--check"], "archive = nowhere: there is no such folder"),
        (&["out", "--check"], "ro-crate-metadata.json"),
    ] {
        let more: &[&str] = if arguments.contains(&"--check") { &[] } else { &["--ledger", "paper.toml"] };
        let named =
            arguments.contains(&"--check") || arguments.contains(&"--author") || arguments.contains(&"--license");
        let names: &[&str] = if named { &[] } else { &names };
        let error = finish(pathmark(folder.path(), &[&["artifact"], arguments, more, names].concat())).with_code(2).err;
        assert!(error.contains(told), "{arguments:?}: {error}");
    }
    // The file of the current folder has YAML that is not read, unless options replace it.
    let error = finish(pathmark(folder.path(), &["artifact", "new", "--ledger", "paper.toml"])).with_code(2).err;
    assert!(error.contains("CITATION.cff:3:8: title: is no text"), "{error}");
    assert_untouched(&before, &snapshot(folder.path()));
}
