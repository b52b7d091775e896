//! Ledgers from outside the program: `examples/ledgers`.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/ledgers").join(name)
}

fn verdicts(folder: &Path, ledger: &Path) -> Vec<Value> {
    let ledger = ledger.display().to_string();
    let told = finish(pathmark(folder, &["claims", ".", "--json", "--ledger", &ledger])).with_code(0).out;
    serde_json::from_str(&told).unwrap()
}

/// Six runs of each command, as hyperfine exports them.
fn hyperfine() -> Value {
    let result = |program: &str, seconds: f64| {
        let times: Vec<f64> = (0..6).map(|run| seconds * (1.0 + 0.01 * f64::from(run))).collect();
        json!({ "command": format!("{program} 100000"), "mean": seconds, "times": times, "exit_codes": vec![0; 6], "parameters": { "n": "100000" } })
    };
    json!({ "results": [result("quick", 0.01), result("bubble", 1.1)] })
}

fn has_python() -> bool {
    let there = Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        eprintln!("python3 is missing: the converters are not run");
    }
    there
}

/// Runs a converter in a folder.
fn convert(folder: &Path, script: &str, input: &str) -> Output {
    Command::new("python3").arg(example(script)).arg(input).current_dir(folder).output().unwrap()
}

/// Samples of a function that takes 2 ns per element, as criterion leaves them.
fn criterion(folder: &Path) {
    for n in [100, 1000, 10000] {
        let own = folder.join(format!("sort/radix/{n}/new"));
        fs::create_dir_all(&own).unwrap();
        let names = json!({ "group_id": "sort", "function_id": "radix", "value_str": n.to_string() });
        let iterations = [10.0, 20.0, 30.0];
        let times: Vec<f64> = iterations.iter().map(|own| own * 2.0 * f64::from(n) * (1.0 + 0.001 * own)).collect();
        let sample = json!({ "sampling_mode": "Linear", "iters": iterations, "times": times });
        fs::write(own.join("benchmark.json"), names.to_string()).unwrap();
        fs::write(own.join("sample.json"), sample.to_string()).unwrap();
    }
}

/// Rows of hyperfine and criterion give verdicts: 1.1 s over 10 ms is 110, and the times are linear.
#[test]
fn rows_of_other_harnesses_are_judged() {
    if !has_python() {
        return;
    }
    let folder = in_memory();
    fs::write(folder.path().join("times.json"), hyperfine().to_string()).unwrap();
    criterion(&folder.path().join("criterion"));
    for (script, input, rows) in
        [("from_hyperfine.py", "times.json", "commands.csv"), ("from_criterion.py", "criterion", "functions.csv")]
    {
        let output = convert(folder.path(), script, input);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        fs::write(folder.path().join(rows), output.stdout).unwrap();
    }
    let told = verdicts(folder.path(), &example("sorting.toml"));
    let of = |key: &str| told.iter().map(|row| row[key].as_str().unwrap()).collect::<Vec<_>>();
    assert_eq!(of("verdict"), ["confirmed", "confirmed"], "{told:?}");
    assert!(of("measured")[0].starts_with("110"), "{told:?}");
    // Estimates alone are one row, of the slope.
    let own = folder.path().join("criterion/sort/radix/100/new");
    fs::remove_file(own.join("sample.json")).unwrap();
    let [mean, slope] = [150.0, 200.0].map(|estimate| json!({ "point_estimate": estimate }));
    fs::write(own.join("estimates.json"), json!({ "mean": mean, "slope": slope }).to_string()).unwrap();
    let rows = String::from_utf8(convert(folder.path(), "from_criterion.py", "criterion").stdout).unwrap();
    let of_hundred: Vec<&str> = rows.lines().filter(|row| row.starts_with("sort,radix,100,")).collect();
    assert_eq!(of_hundred, ["sort,radix,100,0,2e-07,"]);
    assert_eq!(rows.lines().count(), 1 + 1 + 3 + 3, "{rows}");
    // The rows tell their time, so that they are known to be younger than a bound of 2001.
    let text = fs::read_to_string(example("sorting.toml")).unwrap();
    let old = text.replace("2026-11-28T05:00:00Z", "2001-01-01T00:00:00Z");
    fs::write(folder.path().join("old.toml"), old).unwrap();
    let strict = ["claims", ".", "--ledger", "old.toml", "--strict"];
    let told = finish(pathmark(folder.path(), &strict)).with_code(0).out;
    assert_eq!(told.matches("bound older than its rows").count(), 2, "{told}");
    // A wrong row is told with file, line, field and value.
    let path = folder.path().join("commands.csv");
    fs::write(&path, fs::read_to_string(&path).unwrap().replacen(",0,0.01", ",0,fast", 1)).unwrap();
    let ledger = example("sorting.toml").display().to_string();
    let error = finish(pathmark(folder.path(), &["claims", ".", "--ledger", &ledger])).with_code(2).err;
    assert!(error.contains("commands.csv:2:") && error.contains("seconds = fast"), "{error}");
}

/// Runs that failed have no seconds: one of 10 s would change the ratio. The last one was ended by a signal.
#[test]
fn failed_runs_of_hyperfine_are_not_measured() {
    if !has_python() {
        return;
    }
    let folder = in_memory();
    let mut results = hyperfine();
    let own = &mut results["results"][0];
    own["exit_codes"] = json!([0, 3, 0, 0, 0, Value::Null]);
    (own["times"][1], own["times"][5]) = (json!(10.0), json!(1e-6));
    let write = |results: &Value| fs::write(folder.path().join("times.json"), results.to_string()).unwrap();
    write(&results);
    let output = convert(folder.path(), "from_hyperfine.py", "times.json");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(told, "times.json: quick 100000: 2 of 6 runs failed, so their seconds are empty\n");
    fs::write(folder.path().join("commands.csv"), output.stdout).unwrap();
    let told = verdicts(folder.path(), &example("sorting.toml"));
    assert!(told[0]["verdict"] == "confirmed" && told[0]["measured"].as_str().unwrap().starts_with("110"), "{told:?}");
    assert!(told[0]["rule"].as_str().unwrap().contains("4 repetitions"), "{told:?}");
    // Codes of other runs than the times are refused.
    results["results"][0]["exit_codes"] = json!([0]);
    write(&results);
    let output = convert(folder.path(), "from_hyperfine.py", "times.json");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && told.contains("quick 100000: 6 times and 1 exit_codes"), "{told}");
}

/// The plan of a ledger on other programs has the commands that it tells.
#[test]
fn a_plan_tells_the_commands_of_other_programs() {
    let folder = in_memory();
    let ledger = example("sorting.toml").display().to_string();
    let plan = |more: &[&str]| {
        let all = [&["claims", ".", "--ledger", &ledger, "--plan"], more].concat();
        finish(pathmark(folder.path(), &all)).with_code(0).out
    };
    let told: Vec<Value> = serde_json::from_str(&plan(&["--json"])).unwrap();
    assert!(told[0]["command"].as_str().unwrap().starts_with("hyperfine "), "{told:?}");
    assert_eq!((&told[0]["seconds"], &told[0]["bytes"]), (&json!(40.0), &json!(2000)), "{told:?}");
    assert_eq!((&told[0]["machine"], &told[1]["command"]), (&json!("an invented machine"), &json!("cargo bench")));
    let text = plan(&[]);
    assert!(
        text.contains("  # 40 s, 2.0 kB, on an invented machine, rows of another program, in commands.csv\n"),
        "{text}"
    );
    assert!(text.ends_with("2 tables of other programs, as the ledger tells it: 40 s, 1 without a time\n"), "{text}");
    assert!(!text.contains("0 experiments"), "{text}");
}

/// A sentence of a library's README, by rows of `bursts`.
#[test]
fn rows_of_bursts_are_a_table_like_any_other() {
    let folder = in_memory();
    let head = "process,round,place,strategy,threads,regions,jobs,job_s,gap_s,slept_s,wake_s,wake_p95_s,region_s,idle_processors,started";
    let row = |process: u32, strategy: &str, region_s: f64| {
        let noise = 1.0 + 0.01 * f64::from(process);
        format!("{process},0,0,{strategy},2,100,8,5e-6,0.00002,0,{},0,{},0.1,0\n", 0.1 * region_s * noise, region_s)
    };
    let rows: String =
        (0..6).flat_map(|process| [row(process, "rayon", 28e-6), row(process, "forkunion", 2e-6)]).collect();
    fs::create_dir(folder.path().join("bursts")).unwrap();
    fs::write(folder.path().join("bursts/bursts.csv"), format!("{head}\n{rows}")).unwrap();
    let told = verdicts(folder.path(), &example("forkunion.toml"));
    assert_eq!((&told[0]["verdict"], &told[0]["measured"]), (&json!("confirmed"), &json!("14")), "{told:?}");
    assert_eq!(told[1]["verdict"], "confirmed", "{told:?}");
}

/// The fifth report is judged by committed rows that are younger than the ledger, with the verdicts that its page tells.
#[test]
fn a_report_from_outside_is_judged_by_the_committed_rows() {
    let results = Path::new(env!("CARGO_MANIFEST_DIR")).join("results");
    let ledger = example("kth.toml").display().to_string();
    let command = ["claims", "reports-2", "reports-3", "--ledger", &ledger, "--strict", "--json"];
    let told = finish(pathmark(&results, &command)).with_code(0).out;
    let told: Vec<Value> = serde_json::from_str(&told).unwrap();
    assert_eq!((&told[0]["verdict"], &told[1]["verdict"]), (&json!("refuted"), &json!("open")), "{told:?}");
    let page = fs::read_to_string(example("README.md")).unwrap();
    for row in &told {
        assert!(page.contains(row["measured"].as_str().unwrap()), "{row:?}");
    }
}

/// Numbers of claims are unique over the ledgers of a folder, and a plan names a command for each claim.
#[test]
fn a_folder_of_ledgers_is_read_together_and_planned() {
    let folder = in_memory();
    fs::create_dir(folder.path().join("papers")).unwrap();
    let ledger = |report: &str, id: u32, experiment: &str| {
        format!(
            "report = \"{report}\"\ntitle = \"T\"\nabout = \"A.\"\n[[claim]]\nid = {id}\nclaim = \"Samples.\"\n\
             experiment = \"{experiment}\"\nstatistic = \"value\"\ncolumn = \"spp\"\nlevel = 0.95\n"
        )
    };
    let write = |name: &str, text: &str| fs::write(folder.path().join("papers").join(name), text).unwrap();
    write("a.toml", &ledger("a", 1, "timelines"));
    write("b.toml", &ledger("b", 1, "no-such"));
    let refused = || finish(pathmark(folder.path(), &["claims", ".", "--ledger", "papers"])).with_code(2).err;
    assert!(refused().contains("b.toml") && refused().contains("id = 1"), "{}", refused());
    write("b.toml", &ledger("a", 2, "no-such"));
    assert!(refused().contains("report = a"), "{}", refused());
    write("b.toml", &ledger("b", 2, "no-such"));
    let plan = ["claims", ".", "--ledger", "papers", "--plan", "--json"];
    let told: Vec<Value> = serde_json::from_str(&finish(pathmark(folder.path(), &plan)).with_code(0).out).unwrap();
    assert_eq!(told[0]["command"], "pathmark run timelines --reports", "{told:?}");
    assert!(told[0]["seconds"].as_f64().unwrap() > 0.0 && told[0]["bytes"].as_u64().unwrap() > 0, "{told:?}");
    assert!(told[1]["command"] == "" && told[1]["why"].as_str().unwrap().contains("no-such"), "{told:?}");
    let text = finish(pathmark(folder.path(), &["claims", ".", "--ledger", "papers", "--markdown"])).with_code(0).out;
    assert!(text.starts_with("# The claims of papers\n"), "{text}");
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert!(finish(pathmark(folder.path(), &["claims", ".", "--ledger", "empty"])).with_code(2).err.contains(".toml"));
}

/// A typing error in a query, or a claim without rows, fails `--strict`, and the starter has the time of its making.
#[test]
fn typing_errors_do_not_pass_a_strict_check() {
    let folder = in_memory();
    let rows = "command,n,repetition,seconds,started_utc\n";
    let row = |command: &str, repetition: u32, seconds: u32| {
        format!("{command} 100000,100000,{repetition},{seconds}.{repetition},9999-01-01T00:00:00Z\n")
    };
    let all: String = (0..6).flat_map(|own| [row("quick", own, 1), row("bubble", own, 90)]).collect();
    fs::write(folder.path().join("commands.csv"), format!("{rows}{all}")).unwrap();
    let ledger = fs::read_to_string(example("sorting.toml")).unwrap();
    let first = ledger.split("[[claim]]").take(2).collect::<Vec<&str>>().join("[[claim]]");
    let write = |text: &str| fs::write(folder.path().join("own.toml"), text).unwrap();
    let strict = || finish(pathmark(folder.path(), &["claims", ".", "--ledger", "own.toml", "--strict"]));
    write(&first);
    strict().with_code(0);
    let line = |text: &str, what: &str| 1 + text.lines().position(|line| line.contains(what)).unwrap();
    let wrong = first.replace("\"bubble 100000\"", "\"buble 100000\"");
    write(&wrong);
    let (error, place) = (strict().with_code(2).err, line(&wrong, "\"buble"));
    assert!(error.contains(&format!("own.toml:{place}:20: rows.command = buble 100000")), "{error}");
    assert!(error.contains("bubble 100000, quick"), "{error}");
    let wrong = first.replace("commands.csv\"", "comands.csv\"");
    write(&wrong);
    let (error, place) = (strict().with_code(2).err, line(&wrong, "comands.csv\""));
    assert!(error.contains(&format!("own.toml:{place}:8: file = comands.csv")), "{error}");
    // Rows of an experiment may be absent, which `--strict` does not expect.
    let of_experiment = "[[claim]]\nid = 3\nclaim = \"c\"\nexperiment = \"thread-scalin\"\nstatistic = \"value\"\ncolumn = \"spp\"\nlevel = 0.95\n";
    write(&format!("{first}{of_experiment}"));
    let told = strict().with_code(1);
    assert!(told.err.contains("claims 3 have no rows that answer them"), "{}", told.err);
    assert!(told.out.contains("No judged folder has rows of thread-scalin."), "{}", told.out);
    finish(pathmark(folder.path(), &["claims", ".", "--ledger", "own.toml"])).with_code(0);

    let before = pathmark::measure::utc_now();
    finish(pathmark(folder.path(), &["new", "claims", "paper"])).with_code(0);
    let text = fs::read_to_string(folder.path().join("paper.toml")).unwrap();
    let frozen = text.split_once("\nfrozen = \"").unwrap().1.split_once('"').unwrap().0.to_string();
    assert!(before <= frozen && frozen <= pathmark::measure::utc_now(), "{before} {frozen}");
    finish(pathmark(folder.path(), &["claims", ".", "--ledger", "paper.toml"])).with_code(0);
}

/// The plan knows the definitions of rows in the judged folders, and those in the current one.
#[test]
fn a_plan_knows_experiments_of_ones_own() {
    let folder = in_memory();
    write_tiny(folder.path(), TINY);
    fs::write(folder.path().join("paper.toml"), crate::artifact::ledger()).unwrap();
    let plan = |folders: &[&str]| {
        let words = [&["claims"][..], folders, &["--ledger", "paper.toml", "--plan", "--json"]].concat();
        let told: Vec<Value> = serde_json::from_str(&finish(pathmark(folder.path(), &words)).with_code(0).out).unwrap();
        assert!(told[0]["command"] == "", "{told:?}");
        (told[1]["command"].as_str().unwrap().to_string(), told[1]["bytes"].as_u64())
    };
    let (command, bytes) = plan(&[]);
    assert!(command == "pathmark run tiny.toml --quick" && bytes > Some(0), "{command}");
    let words: Vec<&str> = command.split(' ').skip(1).collect();
    finish(pathmark(folder.path(), &words)).with_code(0);
    fs::remove_file(folder.path().join("tiny.toml")).unwrap();
    let (command, bytes) = plan(&["none", "out"]);
    assert!(command == "pathmark replicate out/tiny" && bytes > Some(0), "{command}");
    assert_eq!(plan(&["none"]), (String::new(), None));
    // A definition that cannot be read is no end of the plan.
    fs::write(folder.path().join("tiny.toml"), "title = 1\n").unwrap();
    assert_eq!(plan(&["none"]), (String::new(), None));
}
