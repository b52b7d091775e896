//! Time limits of cells: a cell that hangs is ended with all of its processes, its rows say so, and the sweep goes on.

use crate::experiment::{TINY, write_tiny};
use crate::external::{runs, table};
use crate::program::{finish, pathmark};
use crate::watchdog::Watchdog;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

/// Two processes that never end, whose ids the file `pids` gets.
const HANG: &str = "sleep 1000 & echo $$ $! >> pids; wait";

fn rows(folder: &Path) -> Vec<BTreeMap<String, String>> {
    let reader = csv::Reader::from_path(folder.join("out/tiny/records.csv")).unwrap();
    reader.into_deserialize().map(Result::unwrap).collect()
}

/// Waits until none of the processes in the file `pids` runs: killed processes end soon. The file is absent if the
/// machine is so busy that they did not even start within the limit.
fn wait_until_ended(folder: &Path) {
    let pids = fs::read_to_string(folder.join("pids")).unwrap_or_default();
    while pids.split_whitespace().any(runs) {
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Both cells of another program hang. With a file that lets them go on and without a limit, the resumed sweep runs
/// them again.
#[test]
fn another_program_that_hangs_is_ended_and_run_again_by_resume() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    let image = r"(printf 'PF\\n24 16\\n-1.0\\n'; head -c 4608 /dev/zero) > $0";
    let command = format!(r#""sh", "-c", "test -e go || {{ {HANG}; }}; {image}", "{{out}}", "{{spp}}", "{{seed}}""#);
    let text = TINY.replace("[\"speedup\", \"schedules\"]", "[\"schedules\"]\ntimeout = \"1 s\"");
    let text = text.replace("[quick]\n", &format!("{}\n[quick]\n", table(&command)));
    write_tiny(folder.path(), &text.replace("repetitions = 3", "repetitions = 1"));
    let sweep = ["run", "tiny.toml", "--out", "out", "--filter", "estimator=other"];
    let finished = finish(pathmark(folder.path(), &sweep)).with_code(1);
    assert!(finished.err.contains("2 of 2 rows failed, 2 of them at their time limit"), "{}", finished.err);
    let errors: Vec<String> = rows(folder.path()).into_iter().map(|row| row["error"].clone()).collect();
    assert!(errors.len() == 2 && errors.iter().all(|error| error.starts_with("timed-out: ")), "{errors:?}");
    assert!(errors.iter().all(|error| error.contains("limit of 1s")), "{errors:?}");
    wait_until_ended(folder.path());
    fs::write(folder.path().join("go"), "").unwrap();
    let resumed = [&sweep[..], &["--resume", "--timeout", "none"]].concat();
    finish(pathmark(folder.path(), &resumed)).with_code(0);
    let rows = rows(folder.path());
    assert!(rows.len() == 2 && rows.iter().all(|row| row["error"].is_empty()), "{rows:?}");
}

/// A launcher of ranks that never ends. The command's limit replaces that of the profile, which replaces the file's.
#[test]
fn ranks_that_hang_are_ended() {
    let _watchdog = Watchdog::new(Duration::from_mins(2));
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("launcher"), HANG).unwrap();
    let ranks = "strategy = [\"work-stealing\"]\nranks = [2]\nrank-rule = [\"static-blocks\"]";
    let text = TINY.replace("strategy = [\"serial\", \"static-blocks\", \"work-stealing\"]", ranks);
    let text = text.replace("[\"speedup\", \"schedules\"]", "[\"schedules\"]\ntimeout = \"none\"");
    let limited = |timeout: &str| text.replace("repetitions = 3", &format!("repetitions = 1\ntimeout = \"{timeout}\""));
    for (profile, option) in [("1s", &[] as &[&str]), ("none", &["--timeout", "1s"])] {
        fs::remove_dir_all(folder.path().join("out")).ok();
        write_tiny(folder.path(), &limited(profile));
        let arguments = [&["run", "tiny.toml", "--out", "out", "--filter", "threads=1"], option].concat();
        let mut sweep = pathmark(folder.path(), &arguments);
        sweep.env("PATHMARK_MPIEXEC", "sh launcher");
        let finished = finish(sweep).with_code(1);
        assert!(finished.err.contains("1 of 1 rows failed, 1 of them at their time limit"), "{}", finished.err);
        assert!(rows(folder.path())[0]["error"].starts_with("timed-out: "), "{:?}", rows(folder.path()));
        wait_until_ended(folder.path());
    }
}
