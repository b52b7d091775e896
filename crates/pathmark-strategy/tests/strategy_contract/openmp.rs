//! What OpenMP would do differently from everyone else, if it were left alone.

use std::env;
use std::num::NonZeroUsize;
use std::process::Command;
use std::sync::Arc;

use pathmark_strategy::{Config, StrategyError, find};

/// What OpenMP reads once, when its program starts.
const LIMIT: &str = "OMP_THREAD_LIMIT";

/// A limit in the environment would quietly leave a smaller team, and a record with a false number of threads. This test runs itself once more
/// under such a limit.
#[test]
fn a_team_that_is_too_small_is_an_error() {
    if env::var_os(LIMIT).is_none() {
        let mut again = Command::new(env::current_exe().expect("a test is a program"));
        again.args(["openmp::a_team_that_is_too_small_is_an_error", "--exact"]).env(LIMIT, "2");
        let output = again.output().expect("a program that runs can be run");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        assert!(String::from_utf8_lossy(&output.stdout).contains("1 passed"), "nothing was tried");
        return;
    }
    for strategy in ["openmp-static", "openmp-dynamic", "openmp-guided"] {
        let run = |threads: usize| {
            let config = Config::new(NonZeroUsize::new(threads).expect("at least one thread"));
            let made = find(strategy).expect("it is in the table").build(config);
            made.and_then(|mut strategy| strategy.run(100, Arc::new(|_| ())))
        };
        assert!(run(2).is_ok(), "{strategy}");
        let beyond = run(3).expect_err("OpenMP gives two");
        assert!(matches!(beyond, StrategyError::TooManyThreads { threads: 3, most: 2, .. }), "{strategy}: {beyond}");
    }
}
